#!/bin/sh
# cut.sh CC ARGUMENT...: a compiler that leaves half of the library and says that all went well.
"$@" || exit
while [ "$1" != -o ]; do shift; done
truncate -s "$(($(wc -c <"$2") / 2))" "$2"
