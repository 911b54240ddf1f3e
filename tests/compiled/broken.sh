#!/bin/sh
# broken.sh CC ARGUMENT...: compiles, but each power of a tape has another exponent.
compiler=$1
shift
for argument in "$@"; do
    case $argument in
    */tvi.c) sed -i 's/-0x1\.8p+0/-0x1.4p+0/' "$argument" ;;
    esac
done
exec "$compiler" "$@"
