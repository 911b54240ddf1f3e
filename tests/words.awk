# words.awk FILE...: finds comments and prose that are not plain English (docs/contributing.md). It fails on
#   - a C or C++ file without a sentence in a comment at its head,
#   - a sentence that opens with a word of `openers`, in a comment, or in prose outside of headings, code and tables,
#   - a word of `retired` in src/, ad/ or include/.
# Sentences with a question mark may open as they like.
BEGIN {
    openers = " Of What Where Those So "
    retired = "crowd|steady|loosen|go_so|springs|silent|blind|twins|cubes|eights"
}

function complain(line, what) { print file ":" line ": " what; failed = 1 }

# checks the sentences of a text that begins in this line
function check(text, line,    rest, sentence, word) {
    gsub(/[ \t\n*]+/, " ", text)
    sub(/^[ *-]*([a-z_0-9]+\.[a-z]+ - )?/, "", text)
    for (rest = text; match(rest, /[.?!][)"`*]*( |$)/); rest = substr(rest, RSTART + RLENGTH)) {
        sentence = substr(rest, 1, RSTART)
        word = sentence
        sub(/[^A-Za-z].*/, "", word)
        if (sentence !~ /[?]$/ && index(openers, " " word " ")) complain(line, "a sentence opens with " word ": " sentence)
    }
    word = rest
    sub(/[^A-Za-z].*/, "", word)
    if (word != rest && index(openers, " " word " ")) complain(line, "a sentence opens with " word ": " rest)
}

function end_paragraph() { if (paragraph != "") check(paragraph, begin); paragraph = "" }
function begin_file() {
    files++
    in_comment = code = 0
    is_prose = FILENAME ~ /\.md$/
    if (!is_prose && $0 !~ /^\/\*/) complain(1, "no comment at the head of the file")
}

FNR == 1 { end_paragraph(); file = FILENAME; begin_file() }

is_prose && /^ *```/ { code = !code; end_paragraph(); next }
is_prose && (code || /^(#|\||\t|<|!)/ || /^ *$/) { end_paragraph(); next }
is_prose && /^ *([-*]|[0-9]+\.) / { end_paragraph(); sub(/^ *([-*]|[0-9]+\.) +/, ""); paragraph = " "; begin = FNR }
is_prose && /^    / && paragraph == "" { next }
is_prose { if (paragraph == "") begin = FNR; paragraph = paragraph " " $0; next }

FILENAME ~ /^(src|ad|include)\// && tolower($0) ~ "(^|[^a-z_])(" retired ")([^a-z_]|$)" { complain(FNR, "a retired word: " $0) }
{
    line = $0
    while (line != "") {
        if (!in_comment) {
            if (!match(line, /\/\*/)) break
            line = substr(line, RSTART + 2)
            in_comment = 1; begin = FNR; comment = ""
        }
        if (match(line, /\*\//)) {
            comment = comment " " substr(line, 1, RSTART - 1)
            line = substr(line, RSTART + 2)
            in_comment = 0
            if (comment ~ /^ *--/) continue
            if (begin == 1 && comment !~ /\.( |$)/) complain(1, "no sentence at the head of the file")
            check(comment, begin)
        } else {
            comment = comment " " line
            break
        }
    }
}
END { end_paragraph(); exit failed || !files }
