#!/bin/sh
# blas_threads.sh PROGRAM DIR
# The same bits for any number of OpenBLAS threads: the program's output with 1, 2 and 4. OpenBLAS is fetched from Debian
# into DIR and not installed, so that the BLAS of the machine stays what it is.
set -eu
program=$(realpath "$1")
mkdir -p "$2" && cd "$2"
ls libopenblas0-pthread_*.deb >/dev/null 2>&1 || apt-get download -qq libopenblas0-pthread
dpkg-deb -x libopenblas0-pthread_*.deb .
blas=$(find "$PWD" -name 'libopenblas.so.0' | head -n 1)
for bodies in 5 20 120; do
    for threads in 1 2 4; do
        LD_PRELOAD=$blas OPENBLAS_NUM_THREADS=$threads "$program" $bodies >"$bodies.$threads"
        cmp "$bodies.1" "$bodies.$threads"
    done
    echo "$bodies bodies: the same bits with 1, 2 and 4 threads of OpenBLAS"
done
