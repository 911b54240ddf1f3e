# abi.awk: writes a program in C that prints what the headers promise to programs that were linked before: prototypes and
# types of callbacks without the names of arguments; structures with their sizes, and each member with its offset, size
# and type; enumerators with their values. It reads the headers as `cc -E` leaves them, with the marks of their lines.
# What it cannot read, the compiler refuses in the program.

# add(STATEMENT): the lines of the program for a declaration at the outermost level
function add(s, body, name, kind)
{
    gsub(/__attribute__ *\(\(__warn_unused_result__\)\)|[ \t]+/, " ", s)
    gsub(/^ +| +$/, "", s)
    if (s == "" || s ~ /^static / || s ~ /^(typedef )?(struct|enum) [a-z_]+( [a-z_]+)?$/) return
    if (s !~ /{/) {
        print "    puts(\"" (s ~ /\)$/ ? without_names(s) : s) "\");"
        return
    }
    kind = s ~ /^(typedef )?enum/ ? "enum" : "struct"
    body = name = s
    sub(/^[^{]*{/, "", body)
    sub(/}[^}]*$/, "", body)
    sub(/^.*} */, "", name)
    if (name == "" && kind == "struct") { sub(/ *{.*$/, "", s); name = s }
    if (kind == "enum") add_enumerators(body)
    else add_members(name, body)
}

# without_names(PROTOTYPE): it without the names of arguments, which follow a blank or a star
function without_names(s, list, count, argument, i, name)
{
    list = substr(s, index(s, "(") + 1)
    count = split(substr(list, 1, length(list) - 1), argument, ", *")
    list = ""
    for (i = 1; i <= count; i++) {
        name = argument[i]
        sub(/\[.*/, "", name)
        if (match(name, /[ *][a-zA-Z_0-9]+$/))
            argument[i] = substr(name, 1, RSTART) substr(argument[i], length(name) + 1)
        sub(/ $/, "", argument[i])
        list = list (i > 1 ? ", " : "") argument[i]
    }
    return substr(s, 1, index(s, "(")) list ")"
}

function add_enumerators(body, count, name, i)
{
    count = split(body, name, ",")
    for (i = 1; i <= count; i++) {
        sub(/=.*/, "", name[i])
        gsub(/ /, "", name[i])
        if (name[i] != "" && name[i] !~ /_COUNT$/) print "    printf(\"" name[i] " %d\\n\", (int)" name[i] ");"
    }
}

# Later declarators of a line have the type of the first one without its stars.
function add_members(struct, body, lines, line, count, part, i, k, name, type, own, tail)
{
    print "    printf(\"" struct " %zu" (body ~ / size *;/ ? " or more" : "") "\\n\", sizeof(" struct "));"
    lines = split(body, line, ";")
    for (i = 1; i <= lines; i++) {
        count = split(line[i], part, ",")
        for (k = 1; k <= count; k++) {
            gsub(/^ +| +$/, "", part[k])
            if (part[k] == "") continue
            name = tail = part[k]
            sub(/\[.*$/, "", name)
            tail = substr(tail, length(name) + 1)
            own = name
            sub(/^.*[ *]/, "", name)
            own = substr(own, 1, length(own) - length(name))
            if (k == 1) { type = own; sub(/[ *]+$/, "", type) } else own = type " " own
            gsub(/ +$/, "", own)
            print "    printf(\"" struct "." name " %zu %zu " own tail "\\n\", offsetof(" struct ", " name \
                  "), sizeof(((" struct " *)0)->" name "));"
        }
    }
}

BEGIN { print "#include \"all.h\"\n#include <stddef.h>\n#include <stdio.h>\n\nint main(void)\n{" }
/^# [0-9]/ { ours = $3 ~ /\/(tvi|jet)[a-z_]*\.h"$/; next }
/^#/ || !ours { next }
{
    for (i = 1; i <= length; i++) {
        c = substr($0, i, 1)
        depth += (c == "{") - (c == "}")
        if (c != ";" || depth) statement = statement c
        else { add(statement); statement = "" }
        if (c == "}" && !depth && statement ~ /\) *{/) { # the body of an inline function
            sub(/ *{.*/, "", statement)
            add(statement)
            statement = ""
        }
    }
    statement = statement " "
}
END { print "}" }
