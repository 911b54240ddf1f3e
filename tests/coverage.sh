#!/bin/sh
# coverage.sh LEAST BUILD
# From what gcc's --coverage wrote below BUILD: how many lines of ad and src were run, file by file, and each line that was
# not; fails below LEAST per cent in total. A line that is compiled several times was run where one of its objects was.
set -eu
least=$1 build=$2
find "$build/ad" "$build/src" -name '*.gcno' | sort | while read -r notes; do
    gcov -t -o "$notes" "$notes" 2>/dev/null
done | awk -v least="$least" '
    function strip(s) { gsub(/^[ \t]+|[ \t]+$/, "", s); return s }
    { split($0, field, ":"); count = strip(field[1]); number = field[2] + 0 }
    number == 0 { if (field[3] == "Source") source = field[4]; next }
    source !~ /^(ad|src)\// || count == "-" { next }
    {
        place = source ":" number
        if (!(place in run)) {
            run[place] = 0
            places[++lines] = place
            file[lines] = source
            text[lines] = strip(substr($0, length(field[1]) + length(field[2]) + 3))
        }
        if (count !~ /^[#=]/) run[place] = 1 # ##### and ===== mark what was not
    }
    END {
        for (i = 1; i <= lines; i++) {
            if (!(file[i] in all)) files[++count_files] = file[i]
            all[file[i]]++
            covered[file[i]] += run[places[i]]
            total += run[places[i]]
        }
        printf "%-24s %6s %6s %7s\n", "file", "lines", "run", "%"
        for (i = 1; i <= count_files; i++) {
            f = files[i]
            printf "%-24s %6d %6d %7.1f\n", f, all[f], covered[f], 100 * covered[f] / all[f]
        }
        if (!lines) { print "no lines of ad and src"; exit 1 }
        percent = 100 * total / lines
        printf "%-24s %6d %6d %7.1f\n", "total", lines, total, percent
        if (total < lines) print "\nnot run:"
        for (i = 1; i <= lines; i++) if (!run[places[i]]) print places[i] ": " text[i]
        if (percent < least) { printf "%.1f%% is below %s%%\n", percent, least; exit 1 }
    }'
