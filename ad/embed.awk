# embed.awk NAME=name FILE...: the text of C files as a C array of lines, for code that is generated from a tape
# (emit.h). Comments and includes of the library's own files are left out, but for texts that are read once for each of
# several kinds of numbers, which have no guard; functions become inline, and the macros of a .c file end with it, as they
# do where each is compiled alone.
function close_file(    i) {
    for (i = 1; i <= macros; i++) put("#undef " macro[i])
    macros = 0
}
function put(line) {
    gsub(/\\/, "&&", line)
    gsub(/"/, "\\\\&", line)
    print "    \"" line "\\n\","
}
# without comments, none of which stands in a string
function without_comments(line,    at, left) {
    for (;;) {
        if (in_comment) {
            if (!(at = index(line, "*/"))) return left
            line = substr(line, at + 2)
            in_comment = 0
        }
        if (!(at = index(line, "/*"))) return left line
        left = left substr(line, 1, at - 1)
        line = substr(line, at + 2)
        in_comment = 1
    }
}
BEGIN {
    type = "((const|unsigned|struct) )?[a-z_0-9]+ \\**"
    print "/* Made by ad/embed.awk. */"
    print "extern const char *const " NAME "[];"
    print "const char *const " NAME "[] = {"
}
# whether no guard keeps it from being read again
function is_text(path,    line, guarded) {
    while ((getline line < path) > 0) if (line ~ /^#ifndef [A-Z_]+_H$/) guarded = 1
    close(path)
    return !guarded
}
function put_file(path,    line) {
    while ((getline line < path) > 0) put_line(line)
    close(path)
}
FNR == 1 { close_file(); in_comment = 0 }
{ put_line($0) }
function put_line(whole,    line, path, word) {
    line = without_comments(whole)
    gsub(/[ \t]+/, " ", line)
    sub(/^ /, "", line)
    sub(/ $/, "", line)
    if (line ~ /^# ?include "/) {
        path = line
        gsub(/^[^"]*"|"$/, "", path)
        if (FILENAME ~ /^src\// && path ~ /\// && is_text("src/" path)) put_file("src/" path)
        return
    }
    if (line == "" || line ~ /^# ?pragma GCC (system_header|visibility)/) return
    if (line ~ "^static (inline )?" type "[a-z_0-9#]+\\(") sub(/^static (inline )?/, "JET_INLINE ", line)
    else if (whole ~ "^(void|bool|double|int) \\**(jet|tvi)_[a-z_0-9]+\\(") line = "JET_INLINE " line
    if (FILENAME ~ /\.c$/ && line ~ /^# ?define /) {
        split(line, word, /[ (]/)
        macro[++macros] = word[line ~ /^# d/ ? 3 : 2]
    }
    put(line)
}
END {
    close_file()
    print "    0,"
    print "};"
}
