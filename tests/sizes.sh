#!/bin/sh
# sizes.sh: no file is longer than 500 lines, no function of ad/ and src/ longer than 40, and the median function of
# src/ has 10 at most. A function's lines are those between its braces, which stand at the beginning of a line.
set -eu
wc -l include/*.h ad/*.[ch] src/*/*.[ch] bench/*/*.[ch] tests/*/*.[ch] src/python/tvi/*.py tests/python/*.py | awk '$2 != "total" && $1 > 500 { print $2 ": " $1 " lines"; failed = 1 } END { exit failed }'
awk '
    FNR == 1 { begin = 0 }
    /^{/ { begin = FNR }
    /){$/ && !/^[ #]/ { begin = FNR }
    /^}/ && begin {
        lines = FNR - begin - 1
        begin = 0
        if (lines > 40) { print FILENAME ":" FNR ": a function of " lines " lines"; failed = 1 }
        if (FILENAME ~ /^src/) count[lines]++
        functions += FILENAME ~ /^src/
    }
    END {
        for (median = 0; below + count[median] < functions / 2; median++) below += count[median]
        print functions " functions in src, their median " median " lines"
        exit failed || !functions || median > 10
    }' ad/*.c src/*/*.c
