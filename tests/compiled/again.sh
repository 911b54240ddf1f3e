#!/bin/sh
# again.sh CC ARGUMENT... -o LIBRARY tvi.c ARGUMENT...: a compiler that gives the library of an earlier time if the text
# and the arguments are the same, so that tests of what is done with libraries need not wait for compilers.
for argument in "$@"; do
    case $argument in
    */tvi.c) text=$argument ;;
    */tvi.so) library=$argument ;;
    esac
done
mkdir -p build/check/again
kept=build/check/again/$({ cat "$text"; echo "$@" | sed "s|$text||; s|$library||"; } | cksum | tr ' ' _)
if [ ! -e "$kept" ]; then
    "$@" || exit
    cp "$library" "$kept.$$" && mv "$kept.$$" "$kept"
fi
exec cp "$kept" "$library"
