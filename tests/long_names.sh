#!/bin/sh
# long_names.sh: no identifier in the code of ad/ and src/ is longer than 32 characters, comments and strings aside.
set -eu
# what others define
foreign='posix_spawn_file_actions_addclosefrom_np'

awk -v most=32 -v foreign="$foreign" '
    FNR == 1 { in_comment = 0 }
    {
        line = $0
        code = ""
        while (line != "") {
            if (in_comment) {
                if (!(end = index(line, "*/"))) break
                line = substr(line, end + 2)
                in_comment = 0
            }
            if (!match(line, /"([^"\\]|\\.)*"|\047([^\047\\]|\\.)*\047|\/\*|\/\//)) { code = code line; break }
            code = code substr(line, 1, RSTART - 1) " "
            found = substr(line, RSTART, RLENGTH)
            line = substr(line, RSTART + RLENGTH)
            if (found == "//") break
            in_comment = found == "/*"
        }
        for (; match(code, /[A-Za-z_][A-Za-z0-9_]*/); code = substr(code, RSTART + RLENGTH)) {
            names++
            name = substr(code, RSTART, RLENGTH)
            if (length(name) <= most || name == foreign) continue
            print FILENAME ":" FNR ": " name " has " length(name) " characters"
            failed = 1
        }
    }
    END { exit failed || !names }' ad/*.[ch] src/*/*.[ch]
