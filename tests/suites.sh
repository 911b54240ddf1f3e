#!/bin/sh
# suites.sh SUITES COMMAND...
# Runs a test program, or what runs it, once for each of SUITES, "suite,suite/case,...", or once for all of them where
# that is empty. A name that selects no test is a failure. After a test that failed, it prints a line "again: " with the
# command that runs this test's case alone, in one process, as a debugger wants it.
set -u
names=${1:-/}
shift
failed=0
output=$(mktemp)
trap 'rm -f "$output"' EXIT
isa=${TVI_ISA:+TVI_ISA=$TVI_ISA }
IFS=,
for selected in $names; do
    unset CK_RUN_SUITE CK_RUN_CASE
    suite=${selected%%/*} case=${selected#"$suite"}
    if [ "$suite" ]; then export CK_RUN_SUITE="$suite"; fi
    if [ "${case#/}" ]; then export CK_RUN_CASE="${case#/}"; fi
    "$@" >"$output" 2>&1 || failed=1
    cat "$output"
    grep -q '^[0-9]*%: Checks: [1-9]' "$output" || {
        echo "no tests in $selected"
        failed=1
    }
    # a line of Check is "file:line:F:case:test:iteration: message"
    sed -nE 's/^[^ :]+:[0-9]+:[FE]:([^:]*):.*/\1/p' "$output" | sort -u | while read -r case; do
        echo "again: ${isa}CK_FORK=no ${suite:+CK_RUN_SUITE='$suite' }CK_RUN_CASE='$case' $(IFS=' '; echo "$*")"
    done
done
exit $failed
