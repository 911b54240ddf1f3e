#!/bin/sh
# cases.sh TABLE BUILD WHEN
# Builds and runs the programs beside the table whose line says WHEN (check or long), against the library in BUILD, and
# compares the last line that each prints with the table. A line is
#     name | owner | check or long | state | the last line of a program that is right
# A program whose state is `passes` has to print that line and to end with 0. One whose state is `fails` must not: once
# it does, its line is to be changed. A program that is not built, or that ends in an exception of Python, is an error
# in either state, and so are a program without a line and a line without a program. TVI_ISA is left out, as the state
# of some depends on it. The first comment of a program may have "Built with: FLAGS". CC, CXX, STRICT, LIBS and PYTHON
# come from the environment.
set -u
table=$1 build=$2 when=$3
folder=$(dirname "$table")
work=$build/check/cases
longest=60 # seconds, after which a program counts as one that hangs
status=0
rm -rf "$work/run-$when"
mkdir -p "$work/locale"
[ -e "$work/locale/de_DE.UTF-8" ] || localedef -i de_DE -f UTF-8 "$work/locale/de_DE.UTF-8" || exit 1
export LOCPATH="$work/locale"
unset TVI_ISA

fail() { echo "$1:$2:F:cases:${3%.*}:0: $4"; status=1; return 0; }

# The programs and the lines are the same names, each once; what a line says can be read.
programs=$(cd "$folder" && ls -- *.c *.cpp *.py 2>/dev/null | grep -v '^verdict\.py$' | sort)
lines=$(grep -v '^#' "$table")
names=$(echo "$lines" | sed 's/ *|.*//' | sort)
[ "$programs" = "$names" ] || {
    echo "$programs" >"$work/programs"
    echo "$names" >"$work/names"
    echo "$table: programs without a line (<), and lines without a program (>):"
    diff "$work/programs" "$work/names" | grep '^[<>]'
    status=1
}
subjects='errors|runs|light bodies|ensembles|faults'
wrong=$(echo "$lines" | grep -vE "^[a-zA-Z0-9_]+\.(c|cpp|py) \\| ($subjects) \\| (check|long) \\| (passes|fails) \\| [^ ]")
[ -z "$wrong" ] || { echo "$table: no line of the table: $wrong"; status=1; }

# make NAME: builds a program of C or C++
make_program() {
    flags=$(sed -n 's/^ \* Built with: \([^*]*\).*/\1/p; /\*\//q' "$folder/$1")
    case $1 in
    *.c) compiler="$CC -std=c11 -D_POSIX_C_SOURCE=200809L" ;;
    *) compiler="$CXX -std=c++17" ;;
    esac
    $compiler -O1 $flags $STRICT -Wshadow -Iinclude -o "$work/$1.out" "$folder/$1" "$build/libtvi.a" $LIBS
}

# run NAME: builds and runs a program in an empty folder; its output is in $work/NAME.log
run() {
    here=$work/run-$when/$1
    mkdir -p "$here"
    case $1 in
    *.py) command="$PYTHON $(cd "$folder" && pwd)/$1" ;;
    *) command=$work/$1.out; make_program "$1" || return 125 ;;
    esac
    (cd "$here" && exec timeout $longest $command) >"$work/$1.log" 2>&1
}

count=0
while read -r line; do
    name=${line%% *}
    state=$(echo "$line" | cut -d'|' -f4 | tr -d ' ') right=$(echo "$line" | cut -d'|' -f5- | sed 's/^ //')
    [ "$(echo "$line" | cut -d'|' -f3 | tr -d ' ')" = "$when" ] && [ -e "$folder/$name" ] || continue
    count=$((count + 1))
    run "$name" </dev/null
    code=$?
    number=$(grep -nF "$name |" "$table" | head -n 1 | cut -d: -f1)
    [ $code = 125 ] && fail "$table" "$number" "$name" "$name is not built" && continue
    last=$(tail -n 1 "$work/$name.log")
    grep -q '^Traceback' "$work/$name.log" && fail "$table" "$number" "$name" "$name does not come to its end: $last" && continue
    now=fails
    [ $code = 0 ] && [ "$last" = "$right" ] && now=passes
    echo "$name: $last (status $code), right is: $right"
    [ $now = "$state" ] && continue
    if [ $now = passes ]; then
        fail "$table" "$number" "$name" "$name prints what is right, and its state is fails: change its line to passes"
    else
        grep '^wrong' "$work/$name.log"
        fail "$table" "$number" "$name" "$name is not right: '$last' (status $code), and not '$right'; $work/$name.log"
    fi
done <<END
$lines
END
echo "100%: Checks: $count"
[ $count -gt 0 ] || status=1
exit $status
