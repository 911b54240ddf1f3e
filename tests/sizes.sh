#!/bin/sh
# sizes.sh: no file is longer than 500 lines, no function of ad/ and src/ longer than 60, and each file of C or C++
# begins with a comment, which has a sentence. A function's lines are those between its braces, which stand at the
# beginning of a line.
set -eu
code=$(find ad src include tests bench docs/examples -name '*.[ch]' -o -name '*.hpp')
wc -l $(echo "$code" | grep -v '\.[ch]pp$') src/python/tvi/*.py tests/python/*.py |
    awk '$2 != "total" && $1 > 500 { print $2 ": " $1 " lines"; failed = 1 } END { exit failed }'
awk '
    FNR == 1 { begin = 0 }
    /^{/ { begin = FNR }
    /){$/ && !/^[ #]/ { begin = FNR }
    /^}/ && begin {
        lines = FNR - begin - 1
        begin = 0
        functions++
        if (lines > 60) { print FILENAME ":" FNR ": a function of " lines " lines"; failed = 1 }
    }
    END { print functions " functions"; exit failed || !functions }' ad/*.c src/*/*.c
awk '
    FNR == 1 { in_head = /^\/\*/; if (!in_head) { print FILENAME ": no comment at the head"; failed = 1 } }
    in_head && /\.( |$)/ { has_sentence[FILENAME] = 1 }
    in_head && /\*\// {
        in_head = 0
        if (!has_sentence[FILENAME]) { print FILENAME ": no sentence at the head"; failed = 1 }
    }
    END { exit failed || !NR }' $code
