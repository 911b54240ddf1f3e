#!/bin/sh
# tables.sh verify|replace BUILD TARGET|all DOCUMENT...
# The generated tables and pictures of the documents: those that `make TARGET` writes, or all. A table stands between two
# lines,
#     <!-- table: PATH : make TARGET -->                or     <!-- table: PATH : make TARGET (times only) -->
#     <!-- end -->
# and is the file BUILD/PATH. A picture follows its line,
#     <!-- picture: PATH : make TARGET -->
#     ![text](FILE)
# where FILE, below the document's folder, is a copy of BUILD/PATH. WITHOUT=TARGET in the environment leaves those of one
# target out of all.
#   verify    makes each target once and compares: cells word by word, numbers within a factor of 2 once they are 1e-12 or
#             more, other words exactly. Columns whose heads end in "(time)" or "(chaotic)" are not compared, nor tables of times only, nor pictures.
#   replace   makes every target, those of times too, and puts the files into the documents.
set -u
mode=$1 build=$2 wanted=$3
shift 3
[ "$mode" = verify ] || [ "$mode" = replace ] || { echo "tables.sh: verify or replace, not $mode" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# ---- What there is: document, line, path, target, "times", "all", or the file of a picture -------------------------------

awk -v OFS='\t' -v wanted="$wanted" -v without="${WITHOUT:-}" '
    function is_wanted(target) { return wanted == target || wanted == "all" && target != without }
    function bad(what) { print FILENAME ":" FNR ": " what > "/dev/stderr"; failed = 1 }
    FNR == 1 && open { print document ": a table without <!-- end -->" > "/dev/stderr"; failed = 1; open = 0 }
    /^<!-- table:/ {
        if (open) bad("a table within a table")
        if ($0 !~ /^<!-- table: [^ ]+ : make [^ ]+( \(times only\))? -->$/) { bad("not a line of a table: " $0); next }
        if (is_wanted($6)) print FILENAME, FNR, $3, $6, ($7 == "(times" ? "times" : "all")
        open = 1; document = FILENAME
    }
    /^<!-- end -->$/ { open = 0 }
    picture != "" {
        if (!match($0, /^!\[.*\]\([^)]+\)$/)) { bad("a picture without its line"); picture = ""; next }
        folder = FILENAME
        if (!sub(/\/[^\/]*$/, "", folder)) folder = "."
        sub(/^!\[.*\]\(/, ""); sub(/\)$/, "")
        if (is_wanted(made_by)) print FILENAME, FNR, picture, made_by, folder "/" $0
        picture = ""
    }
    /^<!-- picture:/ {
        if ($0 !~ /^<!-- picture: [^ ]+ : make [^ ]+ -->$/) { bad("not a line of a picture: " $0); next }
        picture = $3; made_by = $6
    }
    END { if (open) { print document ": a table without <!-- end -->" > "/dev/stderr"; failed = 1 }; exit failed }
' "$@" >"$work/tables" || exit 1
[ -s "$work/tables" ] || { echo "tables.sh: no tables of $wanted in $*" >&2; exit 1; }

# ---- Make -------------------------------------------------------------------------------------------------------------

mkdir -p "$build/verify"
awk -F'\t' -v mode="$mode" '(mode == "replace" || $5 == "all") && !seen[$4]++ { print $4 }' "$work/tables" >"$work/targets"
while read -r target; do
    echo "make $target"
    ${MAKE:-make} --no-print-directory "$target" >"$build/verify/$target.log" 2>&1 </dev/null || {
        echo "make $target failed, the end of $build/verify/$target.log:"
        tail -n 5 "$build/verify/$target.log"
        failed=1
    }
done <"$work/targets"
[ $failed -eq 0 ] || exit 1

# ---- Compare ----------------------------------------------------------------------------------------------------------

# the table of the first file with that of the second from line `start` on
compare() {
    awk -v start="$2" '
        function trim(s) { gsub(/^ +| +$/, "", s); return s }
        function is_number(s) { return s ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?%?$/ }
        function size(x) { x = x < 0 ? -x : x; return x > 1e-12 ? x : 1e-12 }
        function near(a, b) {
            a += 0; b += 0
            if (a * b < 0 && (size(a) > 1e-12 || size(b) > 1e-12)) return 0
            return size(a) <= 2 * size(b) && size(b) <= 2 * size(a)
        }
        function same(a, b,    x, y, i, n) {
            n = split(trim(a), x, /[ (),=]+/)
            if (n != split(trim(b), y, /[ (),=]+/)) return 0
            for (i = 1; i <= n; i++)
                if (x[i] != y[i] && !(is_number(x[i]) && is_number(y[i]) && near(x[i], y[i]))) return 0
            return 1
        }
        function mismatch(what) { print FILENAME ":" FNR ": " what; failed = 1 }
        function compare_row(mine, theirs,    x, y, n, i) {
            n = split(mine, x, "|")
            if (n != split(theirs, y, "|")) { mismatch("another number of columns, made: " theirs); return }
            if (!in_table) { split(mine, head, "|"); if (trim(mine) != trim(theirs)) mismatch("another head, made: " theirs); return }
            if (mine ~ /^\|[-|: ]*$/) return
            for (i = 2; i < n; i++)
                if (trim(head[i]) !~ /\((time|chaotic)\)$/ && !same(x[i], y[i]))
                    mismatch("column \"" trim(head[i]) "\": written " trim(x[i]) ", made " trim(y[i]))
        }
        NR == FNR { if (trim($0) != "") made[++lines] = $0; next }
        FNR <= start || ended { next }
        /^<!-- end -->$/ { ended = 1; if (at < lines) mismatch("the made table goes on: " made[at + 1]); next }
        trim($0) == "" { in_table = 0; next }
        at == lines { mismatch("the made table ends before this line"); ended = 1; next }
        /^\|/ { compare_row($0, made[++at]); in_table = 1; next }
        { in_table = 0; if (!same($0, made[++at])) mismatch("written " $0 ", made " made[at]) }
        END { exit failed }
    ' "$3" "$1"
}

# ---- Replace ----------------------------------------------------------------------------------------------------------

replace() {
    awk -v build="$build" -v wanted="$wanted" -v without="${WITHOUT:-}" '
        function is_wanted(target) { return wanted == target || wanted == "all" && target != without }
        /^<!-- end -->$/ { inside = 0 }
        !inside { print }
        /^<!-- table:/ && is_wanted($6) { inside = 1; while ((getline line < (build "/" $3)) > 0) print line }
    ' "$1" >"$work/new" && cat "$work/new" >"$1"
}

tab=$(printf '\t')
while IFS=$tab read -r document line path target kind; do
    if [ "$mode" = verify ] && [ "$kind" != all ]; then continue; fi
    if [ ! -s "$build/$path" ]; then
        echo "$document:$line: make $target wrote no $build/$path"
        failed=1
    elif [ "$mode" = verify ]; then
        compare "$document" "$line" "$build/$path" || failed=1
    fi
done <"$work/tables"
if [ $failed -eq 0 ] && [ "$mode" = replace ]; then
    for document in "$@"; do replace "$document" || failed=1; done
    while IFS=$tab read -r document line path target kind; do
        [ "$kind" = times ] || [ "$kind" = all ] || cp "$build/$path" "$kind" || failed=1
    done <"$work/tables"
fi
[ $failed -eq 0 ] && echo "$mode: $(wc -l <"$work/tables") tables and pictures in $# documents"
exit $failed
