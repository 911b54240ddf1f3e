#!/bin/sh
# instructions.sh PROGRAM ISA SCENE METHOD ORDER H
# The instructions of one step, counted by callgrind over ten steps of PROGRAM (bench/steps/steps.c) with TVI_ISA=ISA, a line each:
#     library N            of the functions of PROGRAM itself, without what they call in shared libraries
#     total N              of all
#     call CALLER NAME N   of the function called NAME, and all that it calls, where CALLER calls it
set -u
program=$1 isa=$2
shift 2
out=$(mktemp)
trap 'rm -f "$out"' EXIT
TVI_ISA=$isa OPENBLAS_NUM_THREADS=1 valgrind -q --tool=callgrind --callgrind-out-file="$out" --compress-strings=no \
    --compress-pos=no --toggle-collect=measured_steps "$program" "$@" || exit 1
awk -v program="${program##*/}" '
    function name(s) { return substr(s, index(s, "=") + 1) }
    /^ob=/ { own = name($0); sub(/.*\//, "", own); own = own == program; next }
    /^fn=/ { caller = name($0); next }
    /^cfn=/ { callee = name($0); next }
    /^calls=/ { called = 1; next }
    /^[0-9]/ {
        if (called) { inclusive[caller " " callee] += $2; called = 0; next }
        total += $2
        if (own) library += $2
    }
    END {
        if (!library) exit 1
        printf "library %.0f\ntotal %.0f\n", library / 10, total / 10
        for (call in inclusive) printf "call %s %.0f\n", call, inclusive[call] / 10
    }' "$out"
