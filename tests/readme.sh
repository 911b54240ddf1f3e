#!/bin/sh
# readme.sh README.md FOLDER
# Writes the programs of the README into the folder: readme.c, the first fenced block of C, and readme_step.c and
# readme_events.c, the same with the first or the second block of docs/start.md beside it: what is above its line of dots
# before main, what is below it in the place of the lines that choose the step and make the run. Fails where a block or a
# place for one is not found.
set -eu
awk -v folder="$2/" '
     BEGIN                       { file[1] = "readme.c"; file[2] = "readme_step.c"; file[3] = "readme_events.c" }
     FNR == 1                    { if (NR > 1 && block > 1) block = 1; inside = 0 }
     /^```c$/ && !inside         { inside = 1; block++; below = 0; next }
     /^```/                      { inside = 0; next }
     !inside || block > 3        { next }
     NR == FNR && block == 1     { program[++lines] = $0; next }
     NR == FNR                   { next }
     /^\.\.\.$/                  { below = 1; next }
     below                       { statements[block] = statements[block] $0 "\n"; next }
                                 { functions[block] = functions[block] $0 "\n" }
     END {
         for (k = 1; k <= 3; k++)
             for (i = 1; i <= lines; i++) {
                 is_run = program[i] ~ /tvi_suggest_step|tvi_integrate_to/
                 if (is_run) places++
                 if (k > 1 && program[i] ~ /^int main/) printf "%s\n", functions[k] >(folder file[k])
                 if (k > 1 && program[i] ~ /tvi_suggest_step/) printf "%s", statements[k] >(folder file[k])
                 if (k == 1 || !is_run) print program[i] >(folder file[k])
             }
         if (places != 6 || !functions[3] || !statements[2] || !statements[3]) {
             print "no program, no step or no events" >"/dev/stderr"
             exit 1
         }
     }' "$1" "$(dirname "$1")/docs/start.md"
