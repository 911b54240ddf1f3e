#!/bin/sh
# examples.sh STAGE
# Installs below STAGE/usr, builds each program of docs/examples by the command in its first comment, with warnings as errors,
# and compares what it prints with docs/examples/README.md: numbers to 1e-3, errors (written 1e-15) below 1e-12, the rest
# to the letter. CC, MAKE and STRICT come from the environment. Prints SKIP where there is no MPI.
set -eu
stage=$1
tests=$(cd "$(dirname "$0")" && pwd)
examples=$tests/../docs/examples
rm -rf "$stage"
mkdir -p "$stage"
$MAKE -s --no-print-directory install PREFIX="$stage/usr" DESTDIR= >/dev/null
export PKG_CONFIG_PATH="$stage/usr/lib/pkgconfig" LD_LIBRARY_PATH="$stage/usr/lib" OMP_NUM_THREADS=2
export XDG_CACHE_HOME="$stage/cache"
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
cd "$examples"

same() {
    awk -v want="$2" '
        function number(s) { return s ~ /^[-+]?[0-9.]+(e[-+][0-9]+)?$/ }
        {
            if ((getline line <want) <= 0) line = ""
            gsub(/[(),:;]/, " & ")
            gsub(/[(),:;]/, " & ", line)
            n = split($0, got)
            if (split(line, wanted) != n) bad = 1
            for (i = 1; i <= n; i++) {
                d = got[i] - wanted[i]
                if (number(got[i]) && got[i] ~ /e[-+]/) ok = wanted[i] ~ /e-/ && got[i] < 1e-12
                else if (number(got[i])) ok = number(wanted[i]) && wanted[i] !~ /e-/ && d < 1e-3 && d > -1e-3
                else ok = got[i] == wanted[i]
                if (!ok) bad = 1
            }
            if (bad) { print "not as in the README: " $0; exit }
        }
        END { if ((getline line <want) > 0) bad = 1; exit bad || NR == 0 }' "$1"
}

# report SOURCE NAME: what it printed, compared with the README
report() {
    awk -v heading="## $1" '$0 == heading { on = 1; next } /^## / { on = 0 } on && sub(/^    /, "")' README.md |
        grep -v -e '^\(mpi\)\{0,1\}c[c+]* ' >"$stage/$2.want"
    cat "$stage/$2.out"
    same "$stage/$2.out" "$stage/$2.want"
}

for source in *.c *.cpp; do
    name=${source%.c*} standard=-std=c11
    [ "$source" = "$name.c" ] || standard=
    lines=$(wc -l <"$source")
    [ "$lines" -lt 60 ] || { echo "$source has $lines lines"; exit 1; }
    command=$(sed -n 's/^ \* *\(\(mpi\)\{0,1\}c[c+]+* .*[^ ]\) *\*\/$/\1/p' "$source")
    [ -n "$command" ] || { echo "no command in $source"; exit 1; }
    if [ "${command%% *}" = mpicc ] && ! command -v mpicc >/dev/null; then
        echo "SKIP $source: no mpicc"
        continue
    fi
    build=${command%%&&*} run=./a.out
    [ "$build" = "$command" ] || run=${command#*&& }
    rm -f "$stage/a.out"
    sh -c "${build%% *} $standard $STRICT ${build#* } -o '$stage/a.out'"
    (cd "$stage" && sh -c "$run") >"$stage/$name.out"
    report "$source" "$name"
    [ "$name" != ensemble_mpi ] || "$tests/mpi.sh" "$stage"
done
