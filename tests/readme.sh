#!/bin/sh
# readme.sh README.md
# Prints the first fenced block of C; fails where there is none.
set -eu
awk '/^```c$/ && !inside { inside = 1; next }
     /^```/ && inside    { found = 1; exit }
     inside              { print }
     END                 { if (!found) { print "no fenced block of C" >"/dev/stderr"; exit 1 } }' "$1"
