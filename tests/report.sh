#!/bin/sh
# report.sh NAME AGAIN LOG COMMAND...
# Runs the command with its output in the log, and prints a line when it ends. Where it failed, that line is followed by
# the assertions that failed, each with its file, line and message, and by the command that runs each of them alone
# (suites.sh writes both into the log); or by the end of the log, where no assertion failed. AGAIN is the command that
# runs all of this one check. LOG.status says for verdict.sh whether it passed.
set -u
name=$1 again=$2 log=$3
shift 3
mkdir -p "$(dirname "$log")"
rm -f "$log.status"
start=$(date +%s)
"$@" >"$log" 2>&1
status=$?
seconds=$(($(date +%s) - start))
if [ $status -eq 0 ]; then
    checks=$(awk '/^100%: Checks:/ { sum += $3 } END { if (sum) print ", " sum " checks" }' "$log")
    grep '^SKIP' "$log"
    printf 'ok    %s (%d s%s)\n' "$name" "$seconds" "$checks"
    echo ok >"$log.status"
    exit 0
fi
failures=$(grep -E '^[^ :]+:[0-9]+:[FE]:|^again: ' "$log" | head -n 40)
{
    printf 'FAIL  %s (%d s), all of its output: %s\n' "$name" "$seconds" "$log"
    if [ "$failures" ]; then echo "$failures"; else tail -n 25 "$log"; fi | sed 's/^/      | /'
    printf '      again: %s\n' "$again"
} >"$log.failed"
cat "$log.failed" # at once, as other checks print beside this one
rm -f "$log.failed"
echo "FAIL $(basename "$log" .log)" >"$log.status"
exit 1
