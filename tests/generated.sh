#!/bin/sh
# generated.sh BUILD [few]
# Suites of other test programs with integrators that run generated code (tests/problems/generated.c). A line each: runs
# or fails, one of so many rows, one of so many other integrators in a row, the program, its suite (of fuzz, the first
# program and their number). What is to fail is the control: code that is edited. few: those of make check. The code
# is for the base instruction set, which compiles fastest. make check compiles it by clang without optimization and
# inlining, in a quarter of the time, as it tests the text of the code; the others are optimized a little.
set -u
export TVI_ISA=base
case ${2-} in
few) export CC=clang TVI_GENERATED_FLAGS='-O0 -D__always_inline__=unused' ;;
all | '') export TVI_GENERATED_FLAGS=-O1 ;;
esac
build=$1
few='runs 480 9999 generating orders
runs 225 9999 generating geometry
runs 480 9999 generating tangent map
runs 21 9999 generating states
fails 240 9999 generating orders'
all='runs 5 9999 generating orders
runs 5 400 generating geometry
runs 5 9999 generating tangent map
runs 1 12 generating states
runs 1 9999 rescaled orders
runs 1 9999 rescaled structure
runs 1 9999 rescaled tangent
runs 1 9999 rescaled times
runs 1 1 fuzz 1 120
fails 100 9999 generating orders
fails 20 9999 generating geometry
fails 100 9999 generating tangent map
fails 7 9999 generating states
fails 5 9999 rescaled orders
fails 5 9999 rescaled structure
fails 12 9999 rescaled tangent
fails 1 9999 rescaled times
fails 1 1 fuzz 1 20'

# What the controls compile: each coefficient of a sum of products changes from one time to the next, which no rule
# does; in random programs, whose states may do anything, a sum is written elsewhere.
changing='s/p\.coefficient\[t\].=.tape->terms\.coefficient\[term\];/static\tint\tcalls;p.coefficient[t]=tape->terms.coefficient[term]*(1+1e-7*(calls++%7));/'
elsewhere='s/JET_AT(V,.z,.0).=.sum/JET_AT(V,(z+(1L<<40)),0)=sum/'

# run ROWS OTHERS PROGRAM [SUITE]...
run() {
    export TVI_GENERATED="$1 $2"
    program=$build/check/$3-generated name=$3
    shift 3
    case $name in
    fuzz) "$program" "$@" ;;
    *) tests/suites.sh "$*" "$program" ;;
    esac
}

# runs or fails, and run's arguments
one() {
    wanted=$1
    shift
    TVI_GENERATED_COUNTS=$(mktemp)
    export TVI_GENERATED_COUNTS
    [ "$3" = fuzz ] && changing=$elsewhere
    if [ "$wanted" = fails ]; then CC="sh tests/compiled/edited.sh $changing ${CC:-cc}" && export CC; fi
    if run "$@" >"$TVI_GENERATED_COUNTS.log" 2>&1; then status=runs; else status=fails; fi
    grep -q '^no code: ' "$TVI_GENERATED_COUNTS.log" && status=broken
    [ "$status" = "$wanted" ] || cat "$TVI_GENERATED_COUNTS.log"
    shift 2
    awk -v what="$* $status" '{ tape += $1; code += $2; by_tape += $3; by_code += $4 } END {
        printf "%s: %d rows, %d integrators with generated code and %d without, %d and %d steps\n",
            what, NR, code, tape, by_code, by_tape; exit !NR }' "$TVI_GENERATED_COUNTS" || [ "$wanted" = fails ]
    proven=$?
    rm -f "$TVI_GENERATED_COUNTS" "$TVI_GENERATED_COUNTS.log"
    [ "$proven $status" = "0 $wanted" ]
}

case ${2-} in
runs | fails)
    shift
    one "$@"
    ;;
few) echo "$few" | xargs -P 2 -L 1 "$0" "$build" ;;
*) echo "$all" | xargs -P 2 -L 1 "$0" "$build" ;;
esac
