# embed.awk NAME=name FILE...: the text of C files as a C array of lines, for code that is generated from a tape
# (emit.h). Comments and includes of the library's own files are left out, functions become inline, and the macros of a
# .c file end with it, as they do where each is compiled alone.
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
FNR == 1 { close_file(); in_comment = 0 }
{
    line = without_comments($0)
    gsub(/[ \t]+/, " ", line)
    sub(/^ /, "", line)
    sub(/ $/, "", line)
    if (line == "" || line ~ /^# ?include "/ || line ~ /^# ?pragma GCC (system_header|visibility)/) next
    if (line ~ "^static (inline )?" type "[a-z_0-9#]+\\(") sub(/^static (inline )?/, "JET_INLINE ", line)
    else if ($0 ~ "^(void|bool|double|int) \\**(jet|tvi)_[a-z_0-9]+\\(") line = "JET_INLINE " line
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
