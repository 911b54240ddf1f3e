#!/bin/sh
# named.sh FILE.md...
# Checks that the code has what these pages name in backticks: identifiers, and files with the folders before them or
# without. Names with NAME in them, and those in a page's own blocks of code, are examples.
set -eu
folders='src ad include tests bench docs'
{
    # the files and folders, each after a slash; the words of the code without its comments; the lines of the pages
    find $folders Makefile -name __pycache__ -prune -o -print | sed 's,^,file /,'
    {
        find $folders -type f \( -name '*.[ch]' -o -name '*.[ch]pp' \) ! -path 'docs/*' -exec cat {} + |
            sed 's,/\*.*\*/,,; \,/\*,,\,\*/,d; s,//.*,,'
        find $folders Makefile -type f \( -name '*.py' -o -name '*.sh' -o -name '*.mk' -o -name Makefile \) \
            ! -name named.sh -exec cat {} + | sed '/^ *#/d'
    } | grep -oE '[A-Za-z_][A-Za-z0-9_]*' | sort -u | sed 's/^/word /'
    awk '{ print "page " FILENAME ":" FNR ": " $0 }' "$@"
} | awk '
    function check_word(name, place)
    {
        names++
        if (!(name in word)) { print place " the code has no " name; failed = 1 }
    }
    # some path ends with the name, in which a star stands for any part of a file name
    function is_file(name, path)
    {
        sub(/\/$/, "", name)
        if ("/" name in file) return 1
        gsub(/\./, "\\.", name)
        gsub(/\*/, "[^/]*", name)
        for (path in file) if (path ~ "/" name "$") return 1
        return 0
    }
    function check_span(span, place, part, count, i)
    {
        if (span ~ /NAME/ && span !~ /\(NAME\)$/) return
        if (span ~ /^[A-Za-z0-9_*.\/-]+$/ && span ~ /\.(c|h|hpp|cpp|md|sh|awk|txt|py|mk)$|\//) {
            files++
            if (!is_file(span)) { print place " there is no file " span; failed = 1 }
        } else if (span ~ /^\.?[A-Za-z_][A-Za-z0-9_]*((->|\.)[A-Za-z_][A-Za-z0-9_]*)*$/) {
            count = split(span, part, /->|\./)
            for (i = 1; i <= count; i++) if (part[i] != "") check_word(part[i], place)
        } else if (match(span, /^[A-Za-z_][A-Za-z0-9_]*\(/)) check_word(substr(span, 1, RLENGTH - 1), place)
    }

    $1 == "file" { file[$2]; next }
    $1 == "word" { word[$2]; next }
    {
        line = $0
        sub(/^page [^ ]* /, "", line)
        if (line ~ /^ *```/) { fenced = !fenced; next }
        if (line == "") open = ""
        if (fenced || line ~ /^      /) {
            for (; match(line, /[A-Za-z_][A-Za-z0-9_]*/); line = substr(line, RSTART + RLENGTH))
                word[substr(line, RSTART, RLENGTH)]
            next
        }
        for (line = open line; match(line, /`[^`]+`/); line = substr(line, RSTART + RLENGTH)) {
            span[++spans] = substr(line, RSTART + 1, RLENGTH - 2)
            place[spans] = $2
        }
        open = line ~ /`/ ? substr(line, index(line, "`")) " " : ""
    }
    END {
        for (i = 1; i <= spans; i++) check_span(span[i], place[i])
        print names + 0 " names and " files + 0 " files that pages name are in the code"
        exit failed || !names || !files
    }'
