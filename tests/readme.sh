#!/bin/sh
# readme.sh README.md FOLDER
# Writes the programs of the README into the folder: readme.c, the first fenced block of C, and readme_events.c, the same
# with the second block: what is above its line of dots before main, what is below it in the place of the loop. Fails where
# a block or a place for one is not found.
set -eu
awk -v plain="$2/readme.c" -v events="$2/readme_events.c" '
     /^```c$/ && !inside         { inside = 1; block++; below = 0; next }
     /^```/                      { inside = 0; next }
     !inside || block > 2        { next }
     block == 1                  { program[++lines] = $0; next }
     /^\.\.\.$/                  { below = 1; next }
     below                       { statements = statements $0 "\n"; next }
                                 { functions = functions $0 "\n" }
     END {
         for (i = 1; i <= lines; i++) {
             print program[i] >plain
             if (program[i] ~ /^int main/) { printf "%s\n", functions >events; places++ }
             if (program[i] ~ /^    while/) { printf "%s", statements >events; loop = i; places++ }
             if (!loop || i > loop + 1) print program[i] >events
         }
         if (places != 2 || !functions || !statements) { print "no program, or no events" >"/dev/stderr"; exit 1 }
     }' "$1"
