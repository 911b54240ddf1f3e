#!/bin/sh
# verdicts.sh FOLDER
# The last line of make check (verdict.sh), of checks that report.sh has run: what passes, fails, is skipped or is missing.
set -eu
rm -rf "$1"
mkdir -p "$1"
run() { tests/report.sh "$1" again "$folder/check-$1.log" sh -c "$2" >"$folder/reported" || true; }
# expect TEXT CHECK...: the verdict of the checks has this line, as the last one
expect() {
    text=$1
    shift
    tests/verdict.sh check $(for name; do echo "$folder/check-$name.log"; done) >"$folder/verdict" || true
    [ "$(tail -n 1 "$folder/verdict")" = "make check: $text" ] || { cat "$folder/verdict"; echo "not: $text"; exit 1; }
}
folder=$1
run one 'printf "Running suite(s): a\n b\n100%%: Checks: 12, Failures: 0, Errors: 0\n"'
run two 'printf "Ran 3 tests in 1.0s\nSKIP it: no mpicc\n"'
run three 'exit 1'
expect 'all 2 checks pass, with 15 tests of 3 suites' one two
grep -q 'SKIP it: no mpicc' "$folder/verdict"
expect 'FAIL, 1 of 2 checks pass; not: check-three' one three
run one 'exit 1'
expect 'FAIL, 1 of 4 checks pass; not: check-one check-three 1 that did not run' one two three four
! tests/verdict.sh check "$folder/check-one.log" >/dev/null
tests/verdict.sh check "$folder/check-two.log" >/dev/null
echo 'verdicts: all as expected'
