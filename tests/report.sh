#!/bin/sh
# report.sh NAME LOG COMMAND...
# Runs the command with its output in the log, and prints a line on how it went: the summaries of Check where there are
# some, the end of the log where it failed.
set -u
name=$1 log=$2
shift 2
mkdir -p "$(dirname "$log")"
start=$(date +%s)
"$@" >"$log" 2>&1
status=$?
seconds=$(($(date +%s) - start))
if [ $status -eq 0 ]; then
    checks=$(awk '/^100%: Checks:/ { sum += $3 } END { if (sum) print ", " sum " checks" }' "$log")
    grep '^SKIP' "$log"
    printf 'ok    %s (%d s%s)\n' "$name" "$seconds" "$checks"
    exit 0
fi
printf 'FAIL  %s (%d s), the end of %s:\n' "$name" "$seconds" "$log"
tail -n 25 "$log" | sed 's/^/      | /'
exit 1
