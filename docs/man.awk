# man.awk - a manual page from the comments and declarations of a header, and of those that it includes.
#   awk -v version=V -v date=D -v example=program.c -f man.awk tvi.h [tvi_runs.h ...] > tvi.3
#   awk -v names=1 -f man.awk tvi.h ...        the functions that they declare, one a line
#
# The first comment gives name and description (that of a further header is left out), a ruler comment a section, a comment
# at the beginning of a line the text of the declarations that follow it up to the next empty line. What is for C++ or one
# compiler alone is left out, and so is what only the library's own macros use.

BEGIN { WIDTH = 72 } # of what is not filled: 80 with the margin of the page

function escape(s) { gsub(/\\/, "\\e", s); return s }
function code_line(s) { s = escape(s); gsub(/-/, "\\-", s); return s ~ /^[.']/ ? "\\&" s : s }
function text_line(s) { s = escape(s); return s ~ /^[.']/ ? "\\&" s : s }

# the paragraph macro, but not after another or after a section
function put(s) { if (!names && !(s == ".PP" && last ~ /^\.(PP|SH|RS)/)) print s; last = s }
function section(title) { put(".SH \"" title "\"") }

# "  TVI_EINVAL  text", "  TVI_EINVAL, TVI_ENOMEM  text", "  others  text", "  1. text" begin an item; what is indented otherwise continues it, the rest is a paragraph.
function print_text(text, count,    i, s, item)
{
    for (i = 1; i <= count; i++) {
        s = text[i]
        if (match(s, /^  +(TVI_[A-Z]+(, TVI_[A-Z]+)*|others|[0-9]+\.) +/)) {
            item = substr(s, 1, RLENGTH)
            gsub(/^ +| +$/, "", item)
            put(".TP\n.B " item)
            s = substr(s, RLENGTH + 1)
        } else if (s !~ /^  / && i > 1 && text[i - 1] ~ /^  /) put(".PP")
        else if (s == "") s = ".PP"
        sub(/^ +/, "", s)
        put(s == ".PP" ? s : text_line(s))
    }
}

function internal(    i)
{
    for (i = 1; i <= lines; i++)
        if (line[i] ~ /jet_record|tvi_own_|jet_node|jet_slot|jet_function|struct jet |typedef struct (tvi|jet)[a-z_]* [a-z_]*;/) return 1
    return 0
}

# words at most WIDTH wide, the first line after `first`, the others after `rest`; "\001" is a space that stays in its line
function wrap(text, first, rest,    word, count, i, s)
{
    count = split(text, word, " ")
    s = first word[1]
    for (i = 2; i <= count; i++) {
        if (length(s " " word[i]) > WIDTH) { put_line(s); s = rest word[i] } else s = s " " word[i]
    }
    put_line(s)
}
function put_line(s) { gsub("\001", " ", s); put(code_line(s)) }

# a declaration or a member: a comment that does not fit behind it stands below it, as do arguments behind a long name
function print_code(s,    margin, code, remark)
{
    if (length(s) <= WIDTH) { put(code_line(s)); return }
    match(s, /^ */)
    margin = substr(s, 1, RLENGTH)
    code = remark = substr(s, RLENGTH + 1)
    if (!sub(/^.*\/\*/, "/*", remark)) remark = ""
    sub(/ *\/\*.*/, "", code)
    if (gsub(/, /, ",\002", code)) gsub(/ /, "\001", code)
    gsub("\002", " ", code)
    if (index(code " ", " ") > WIDTH) sub(/\(/, "( ", code)
    sub(/ \*\/$/, "\001*/", remark)
    if (code != "") wrap(code, margin, margin "        ")
    if (remark != "") wrap(remark, code == "" ? margin : margin "    ", (code == "" ? margin : margin "    ") "   ")
}

# lines of a declaration that belong together: up to the end of its comment, or of its arguments
function join_lines(    i, joined)
{
    for (i = 1; i <= lines; i++) {
        if (i > 1 && (line[joined] ~ /\/\*/ && line[joined] !~ /\*\// || line[joined] ~ /,$/ && line[joined] ~ /\(/)) {
            sub(/^ +(\* )?/, "", line[i])
            line[joined] = line[joined] " " line[i]
        } else line[++joined] = line[i]
    }
    lines = joined
}

function flush(    i)
{
    if (!internal()) {
        if (lines) { put(".PP"); put(".nf") }
        join_lines()
        for (i = 1; i <= lines; i++) {
            gsub(/TVI_STATUS_LIST.*COUNT/, "TVI_OK, TVI_EINVAL, ...", line[i])
            print_code(line[i])
            if (match(line[i], /(tvi|jet)_[a-z_0-9]+\(/) && line[i] !~ /^typedef|^ /)
                name[++count_names] = substr(line[i], RSTART, RLENGTH - 1)
        }
        if (lines) put(".fi")
        if (comments) {
            put(lines ? ".RS 4" : ".PP")
            print_text(comment, comments)
            if (lines) put(".RE")
        }
    }
    lines = comments = 0
}

function add_comment(s)
{
    if (s ~ /^ *\*\/$/) return
    sub(/^\/\* ?/, "", s)
    sub(/ ?\*\/ *$/, "", s)
    sub(/^ \* ?/, "", s)
    comment[++comments] = s
}

function begin()
{
    page = comment[1]
    sub(/\.h .*/, "", page)
    sub(/^[^ ]* - /, "", comment[1])
    comment[1] = toupper(substr(comment[1], 1, 1)) substr(comment[1], 2)
    put(".\\\" made from " page ".h by docs/man.awk")
    put(".TH " toupper(page) " 3 " date " \"tvi " version "\" \"Taylor variational integrators\"")
    section("NAME")
    put(page " \\- functions of Taylor variational integrators")
    section("SYNOPSIS")
    put(".nf\n.B #include <" page ".h>\n.PP\ncc program.c $(pkg\\-config \\-\\-cflags \\-\\-libs tvi) \\-lm\n.fi")
    section("DESCRIPTION")
    print_text(comment, comments)
    comments = 0
    begun = 1
}

# ---- What is compiled for C by any compiler ---------------------------------------------------------------------------
/^#if/      { depth++; hidden[depth] = hidden[depth - 1]; plain_c[depth] = 0 }
/^#ifdef __cplusplus/  { hidden[depth]++; plain_c[depth] = 1 }
/^#ifndef __cplusplus/ { plain_c[depth] = -1 }
/^#if defined/         { hidden[depth]++ }
/^#else/ && plain_c[depth] { hidden[depth] = hidden[depth - 1] + (plain_c[depth] < 0) }
/^#endif/   { depth-- }
hidden[depth] { next }

# ---- Comments ------------------------------------------------------------------------------------------------------------
FNR == 1 && begun { skipped = 1 }
skipped { if (/\*\//) skipped = 0; next }
in_comment { add_comment($0); if (/\*\//) { in_comment = 0; if (!begun) begin() } next }
/^\/\* ----/ {
    flush()
    sub(/^\/\* -+ /, "")
    sub(/ -+ \*\/$/, "")
    section(toupper($0))
    next
}
/^\/\*/ { flush(); add_comment($0); in_comment = !/\*\//; if (!in_comment && !begun) begin(); next }

# ---- Declarations -------------------------------------------------------------------------------------------------------
/^    ROW\(TVI_/ {
    match($0, /TVI_[A-Z]+/)
    code = substr($0, RSTART, RLENGTH)
    match($0, /".*"/)
    put(".TP\n.B " code "\n" text_line(substr($0, RSTART + 1, RLENGTH - 2)))
    next
}
/^    ROW\(/ { next }
/^#define TVI_STATUS_LIST/ { flush(); next }
/^#define jet_/ { # name(arguments) and the remark behind the definition
    signature = $2
    sub(/^#define /, "")
    match($0, /^[a-z_0-9]+\([a-z, ]*\)/)
    signature = substr($0, 1, RLENGTH)
    remark = index($0, "/*") ? substr($0, index($0, "/*")) : ""
    line[++lines] = sprintf("%-16s%s", signature, remark)
    next
}
/^ +\/\*.*\*\/$/ && lines { sub(/^ +/, ""); line[++lines] = sprintf("%-16s%s", "", $0); next }
/^#/ { next }
/^$/ { flush(); next }
{
    sub(/^TVI_NODISCARD /, "")
    if (sub(/^static inline /, "")) in_prototype = 1 # of a definition its prototype alone
    if (in_prototype && /^\{/) { line[lines] = line[lines] ";"; in_prototype = 0; in_body = 1; next }
    if (in_body) { if (/^}/) in_body = 0; next }
    line[++lines] = $0
}
END {
    flush()
    if (names) for (i = 1; i <= count_names; i++) if (!seen[name[i]]++) print name[i]
    section("EXAMPLE")
    put(".nf")
    while (!names && (getline text <example) > 0)
        if (text !~ /^(\/\*| \*)/) put(text == "" ? "\\&" : code_line(text))
    put(".fi")
    section("SEE ALSO")
    put(".BR tvi (3),\n.BR jet (3)\n.br\nMore programs: share/doc/tvi/examples. The mathematics: docs/method.md of the sources.")
}
