#!/bin/sh
# instructions.sh PROGRAM FILE compare|renew COMPILER
# The instructions of one step of each line of FILE, against those written there; or puts them there. COMPILER says what
# the program was compiled by: with another one than FILE's the numbers may differ by a factor of 2 instead of 10 %.
set -u
program=$1 file=$2 mode=$3 compiler=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

grep -v '^#' "$file" | while read -r scene method order h written; do
    counted=$(bench/steps/instructions.sh "$program" base "$scene" "$method" "$order" "$h" </dev/null | awk '/^library/ { print $2 }')
    [ "$counted" ] || { echo "$scene: nothing was counted" >&2; exit 1; }
    echo "$scene $method $order $h $counted $written"
done >"$work/counted" || exit 1

if [ "$mode" = renew ]; then
    { grep '^#' "$file" | sed "s|^# compiler: .*|# compiler: $compiler|"; cut -d' ' -f1-5 "$work/counted"; } >"$work/new"
    cat "$work/new" >"$file" && cat "$file"
    exit
fi

most=1.1
grep -qxF "# compiler: $compiler" "$file" || { most=2; echo "Another compiler: $compiler"; }
awk -v most=$most -v file="$file" '
    {
        ratio = $5 / $6
        far = ratio > most || ratio < 1 / most
        printf "%-16s %s %s, h = %s: %d instructions, %d in %s, ratio %.3f%s\n", $1, $2, $3, $4, $5, $6, file, ratio, far ? "  FAR" : ""
        failed += far
    }
    END {
        if (!NR) { print file " has no lines"; exit 1 }
        if (failed) print "Of " NR " steps " failed " are beyond a factor of " most ". Where that is meant: make instructions"
        exit failed > 0
    }' "$work/counted"
