# prose.awk README.md FILE.md...: prose that is wider than 120 columns in README.md, 100 elsewhere. Tables, code and lines
# that are one link have the width that they need.
FNR == 1 { code = 0; most = FILENAME == "README.md" ? 120 : 100 }
/^ *```/ { code = !code; next }
code || /^(    |\t|\||<!--)/ || /^ *([*-] )?!?\[[^]]*\]\([^)]*\)[.,:]?$/ { next }
length($0) > most { print FILENAME ":" FNR ": prose of " length($0) " columns, " most " at most"; failed = 1 }
END { exit failed || !NR }
