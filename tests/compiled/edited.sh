#!/bin/sh
# edited.sh EDIT CC ARGUMENT...: compiles, but generated text that sed has edited.
edit=$1 compiler=$2
shift 2
for argument in "$@"; do
    case $argument in
    */tvi.c) sed -i "$edit" "$argument" ;;
    esac
done
exec "$compiler" "$@"
