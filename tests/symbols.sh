#!/bin/sh
# symbols.sh LIBRARY.so LIBRARY.a ABI
# The shared library exports the functions of the file ABI (abi.sh) and nothing else; the objects hold no data that can be written to,
# and refer to nothing that prints, exits, reads or writes numbers by the rules of a locale, or allocates where the tests
# would not see it. Three may: progress.o prints to stderr, text.o formats all text, and files.o writes files. The text
# of tvi_last_error, one a thread, is data.
set -u
shared=$1 static=$2 abi=$3
failed=0
complain() {
    echo "$*"
    failed=1
}

exported=$(nm -D --defined-only "$shared" | awk '{ print $3 }')
declared=$(sed -nE '/^typedef/! s/^[^(]*[ *]((tvi|jet)_[a-z_0-9]+)\(.*/\1/p' "$abi")
[ -n "$declared" ] || complain "no declarations found in $abi"
differ=$(printf '%s\n' "$exported" "$declared" | sort | uniq -u)
[ -z "$differ" ] || complain "exported and not declared, or declared and not exported: $differ"

# data that only the loader writes to, to relocate it, is read-only afterwards; DW.ref. is the compiler's, of cleanups
writable=$(size -A "$static" | awk '/ \(ex / { member = $1 }
    $1 ~ /^\.(data|bss|tdata|tbss)/ && $1 !~ /^\.data\.rel\.(ro|local\.DW\.ref\.)/ && $2 > 0 && member $1 != "refusal.o.tbss" { print member, $1, $2 }')
[ -z "$writable" ] || complain "writable data: $writable"
common=$(nm "$static" 2>/dev/null | awk '$2 == "C" { print $3 }')
[ -z "$common" ] || complain "common symbols: $common"

forbidden='v?[fs]?n?printf|puts|fputs|putc|putchar|fputc|fwrite|write|perror|std(in|out|err)|f?open'
forbidden="$forbidden|strto(d|f|ld)|atof|[fs]?scanf|exit|_exit|quick_exit|abort|__assert_fail|raise|longjmp|rand|random|time|clock"
forbidden="$forbidden|strdup|strndup|posix_memalign|memalign|valloc|reallocarray|mmap|sbrk|alloca|dgesv_"
refers=$(nm -u "$static" 2>/dev/null | awk '/:$/ { member = $1 } NF == 2 { print member $2 }' |
    grep -vxE 'progress\.o:(stderr|fputs|fputc|fwrite)|text\.o:(__)?vsnprintf(_chk)?|files\.o:(open|write)' |
    sed 's/.*://' | sort -u |
    grep -xE "(__)?($forbidden)(_chk)?")
[ -z "$refers" ] || complain "refers to $refers"
readers=$(nm -A "$static" 2>/dev/null | awk '$NF == "getenv" { print $1 }' | grep -vE ':(isa|files)\.o:')
[ -z "$readers" ] || complain "reads the environment: $readers" # but for TVI_ISA and compilers

# what a debugger names stands in the sources: no macro makes the name of a function, but for the rules of operations
# and the sums of ad/, whose loops are made for each kind of series. Names have the suffix of the instruction set, and
# those of the compiler's own copies others.
words=$(mktemp)
cat ad/*.[ch] src/*/*.[ch] | grep -oE '[A-Za-z_][A-Za-z_0-9]*' | sort -u >"$words"
unknown=$(nm -A "$static" 2>/dev/null | sed 's/.*:\([a-z_0-9]*\.o\):[0-9a-f]*/\1/' |
    awk '$2 ~ /^[Tt]$/ && $1 !~ /^(rule_|sum_|sweeps_)/ { sub(/\..*/, "", $3); sub(/_avx(2|512)$/, "", $3); print $3 }' | sort -u | comm -23 - "$words")
rm -f "$words"
[ -z "$unknown" ] || complain "functions that no source names: $unknown"
# tables have the same bits with every instruction set
twice=$(nm "$static" 2>/dev/null | awk '$3 ~ /^(tvi_galerkin_compute_tables|tvi_quadrature_compute_nodes|tvi_action_set_tables)_avx/ { print $3 }')
[ -z "$twice" ] || complain "tables are compiled for each instruction set: $twice"

echo "$exported" | wc -l | awk '{ print $1, "exported symbols" }'
exit $failed
