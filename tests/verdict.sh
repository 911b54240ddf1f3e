#!/bin/sh
# verdict.sh TARGET LOG...
# Prints what came of the checks of a target as its last line: how many passed, with how many tests of how many suites,
# or which of them failed; and what they skipped. report.sh has written LOG.status. Fails where a check did not pass.
set -u
target=$1
shift
awk -v target="$target" '
    function plural(count, word) { return count " " word (count == 1 ? "" : "s") }
    FNR == 1 && FILENAME ~ /\.status$/ { if ($1 == "ok") passed++; else failed = failed " " $2; next }
    /^Running suite\(s\): /            { listed = 1 }
    /^[0-9]+%: Checks: /               { listed = 0; tests += $3 }
    listed && NF                       { suites++ }
    /^Ran [0-9]+ tests in /            { tests += $2; suites++ }
    /^SKIP/                            { skipped = skipped "\n      " $0 }
    END {
        for (i = 1; i < ARGC; i++) if (ARGV[i] ~ /\.status$/) known++
        missing = total - known
        if (skipped) print "Skipped:" skipped
        if (failed || missing) {
            print "make " target ": FAIL, " passed + 0 " of " total " checks pass; not:" failed (missing ? " " missing " that did not run" : "")
            exit 1
        }
        print "make " target ": all " plural(passed, "check") " pass, with " plural(tests, "test") " of " plural(suites, "suite")
    }' total=$# $(for log; do for file in "$log.status" "$log"; do [ ! -f "$file" ] || echo "$file"; done; done)
