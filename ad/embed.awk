# embed.awk NAME=name [INCLUDES='dir dir'] FILE...: the text of C files as a C array of lines, for code that is generated
# from a tape (emit.h). The text is what the library itself is compiled from, so that each algorithm stands in one place.
# For that:
#
#   * A file that is included from the directories INCLUDES takes the place of its first include. Other includes of the
#     library's own files are left out: files come in the order in which they need each other.
#   * JET_EMITTED is defined in generated code, and nowhere else.
#   * A function's head begins in the first column and its body with a line that is a brace alone. It becomes
#     JET_INLINE: it begins with static and a type of small letters, or is one of jet_ and tvi_ that gives void, bool,
#     double or int. Others that are static, or begin with a macro (KERNEL_FUNCTION, NEVER), stay as they are. Any other
#     would be defined for the whole program, once in each generated file: that is an error.
#   * Macros of a .c file end with it, as they do where each is compiled alone; those of a .h file are for all behind it.
#   * Comments are left out. They stand in no string and end in their file: else it is an error.
#   * All warnings of gcc and clang are on where tests/compiled/test_alone.c reads the whole with each method.
function fail(what) {
    print FILENAME ":" FNR ": " what > "/dev/stderr"
    failed = 1
}
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
# the file of this path in the directories INCLUDES, if it is there and was not put before
function put_included(path,    i, count, dir, file, line) {
    count = split(INCLUDES, dir, " ")
    for (i = 1; i <= count; i++) {
        file = dir[i] "/" path
        if (file in is_put) return
        if ((getline line < file) <= 0) continue
        is_put[file] = 1
        do put_line(line); while ((getline line < file) > 0)
        close(file)
        return
    }
}
FNR == 1 {
    close_file()
    if (in_comment) fail("a comment of the file before does not end")
    in_comment = 0
}
{ put_line($0) }
function put_line(whole,    line, word) {
    line = without_comments(whole)
    gsub(/[ \t]+/, " ", line)
    sub(/^ /, "", line)
    sub(/ $/, "", line)
    if (line ~ /^# ?include "/) {
        gsub(/^[^"]*"|"$/, "", line)
        put_included(line)
        return
    }
    if (line == "" || line ~ /^# ?pragma GCC (system_header|visibility)/) return
    if (whole ~ /^[^\/]*"[^"]*(\/\*|\*\/)[^"]*"/) fail("a comment in a string")
    if (whole == "{" && head != "" && head !~ /^(JET_INLINE|static) /) fail("a function for the whole program: " head)
    if (line ~ "^static (inline )?" type "[a-z_0-9#]+\\(") sub(/^static (inline )?/, "JET_INLINE ", line)
    else if (whole ~ "^(void|bool|double|int) \\**(jet|tvi)_[a-z_0-9]+\\(") line = "JET_INLINE " line
    if (whole ~ /^[a-zA-Z]/) head = whole ~ /^[a-z][^=;]*\(/ ? line : ""
    if (FILENAME ~ /\.c$/ && line ~ /^# ?define /) {
        split(line, word, /[ (]/)
        macro[++macros] = word[line ~ /^# d/ ? 3 : 2]
    }
    put(line)
}
END {
    close_file()
    if (in_comment) fail("a comment does not end")
    if (failed) exit 1
    print "    0,"
    print "};"
}
