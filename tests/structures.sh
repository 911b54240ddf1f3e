#!/bin/sh
# structures.sh: prints the structures of ad/ and src/ with more than 20 members, and fails if there is one. A part, which
# is a structure within a structure, is one member of the outer one, and its own members are counted apart.
set -eu

awk '
    # the members in the body of a structure: its declarations, and the commas outside of parentheses
    function count_members(body, part, parts, i, members)
    {
        while (gsub(/\{[^{}]*\}|\([^()]*\)|\[[^][]*\]/, "", body));
        parts = split(body, part, ";")
        for (i = 1; i <= parts; i++) if (part[i] ~ /[^ \t]/) members += 1 + gsub(/,/, "", part[i])
        return members
    }
    # all structures in the text of a file
    function check_file(begin, end, depth, head, name, members)
    {
        gsub(/\/\*([^*]|\*+[^*\/])*\*+\//, "", text)
        while (match(text, /(struct|union)( [A-Za-z_0-9]+)? \{/)) {
            head = substr(text, RSTART, RLENGTH)
            begin = RSTART + RLENGTH
            depth = 1
            for (end = begin; depth > 0 && end <= length(text); end++)
                depth += (substr(text, end, 1) == "{") - (substr(text, end, 1) == "}")
            members = count_members(substr(text, begin, end - begin - 1))
            name = split(head, word, " ") == 3 ? word[2] : substr(text, end)
            sub(/^[ *]*/, "", name)
            sub(/[^A-Za-z_0-9].*/, "", name)
            structures++
            if (members > 20) {
                print file ": " name " has " members " members"
                failed = 1
            }
            text = substr(text, begin)
        }
        text = ""
    }
    FNR == 1 { check_file(); file = FILENAME }
    !/^[ \t]*#/ { text = text $0 " " }
    END { check_file(); print structures " structures"; exit failed || !structures }' ad/*.[ch] src/*/*.[ch]
