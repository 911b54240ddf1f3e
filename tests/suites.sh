#!/bin/sh
# suites.sh SUITE[/CASE][,SUITE[/CASE]...] COMMAND...
# Runs the test program once for each suite, or for one case of it. A name that selects no test is a failure.
set -u
names=$1
shift
failed=0
output=$(mktemp)
trap 'rm -f "$output"' EXIT
IFS=,
for selected in $names; do
    CK_RUN_SUITE=${selected%%/*}
    export CK_RUN_SUITE
    unset CK_RUN_CASE
    if [ "$CK_RUN_SUITE" != "$selected" ]; then
        CK_RUN_CASE=${selected#*/}
        export CK_RUN_CASE
    fi
    "$@" >"$output" 2>&1 || failed=1
    cat "$output"
    grep -q '^[0-9]*%: Checks: [1-9]' "$output" || {
        echo "no tests in $selected"
        failed=1
    }
done
exit $failed
