#!/bin/sh
# constants.sh: lists the constants of ad/ and src/ that were found by trials, and counts them. Each has the mark
# /* found: make X */ behind its value; the command shows, by its table or its bounds, what the constant does.
set -eu
awk '
    !/\/\* found: / { next }
    !/^#define [A-Z0-9_]+ +.* +\/\* found: make [a-z].* \*\/$/ {
        print FILENAME ":" FNR ": a mark without a constant, or not of the form /* found: make X */" > "/dev/stderr"
        failed = 1
        next
    }
    {
        name = $2
        value = found = $0
        sub(/^#define [A-Z0-9_]+ +/, "", value)
        sub(/ +\/\* found: .*/, "", value)
        sub(/.*\/\* found: /, "", found)
        sub(/ \*\/$/, "", found)
        printf "%-28s %-32s %-18s %s\n", FILENAME, name, value, found
        marked++
    }
    END {
        print marked + 0 " constants"
        exit failed || !marked
    }' ad/*.[ch] src/*/*.[ch]
