#!/bin/sh
# dist.sh STAGE TARBALL
# Makes the tarball of a release, the same twice, and unpacks it below STAGE. There, with an empty environment, without
# git and without installing packages: builds the library and one test, runs it, installs, and runs the program of the
# README with what is installed. It builds without optimization, which is quick. CC and MAKE come from the environment.
set -eu
stage=$1 tarball=$2
[ -e .git ] || { echo "SKIP the tarball: no checkout of git" && exit 0; }
rm -rf "$stage"
mkdir -p "$stage/path"
echo "echo git \"\$@\" >>'$stage/asked'; exit 1" >"$stage/path/git"
chmod +x "$stage/path/git"

$MAKE -s --no-print-directory dist
cp "$tarball" "$stage/first"
sleep 1 # a time in it would be another one
$MAKE -s --no-print-directory dist
cmp "$tarball" "$stage/first"
tar -xzf "$tarball" -C "$stage"
cd "$stage/$(basename "$tarball" .tar.gz)"

alone() { env -i PATH="$stage/path:$PATH" HOME="$stage" "$@"; }
make() { alone "$MAKE" -s -j2 DEPS=0 CC="$CC" CFLAGS=-O0 PREFIX="$stage/usr" "$@"; }
make
make build/check/bodies
alone build/check/bodies
make install >/dev/null
tests/readme.sh README.md "$stage"
export PKG_CONFIG_PATH="$stage/usr/lib/pkgconfig" LD_LIBRARY_PATH="$stage/usr/lib"
# shellcheck disable=SC2046  # flags are words
$CC -o "$stage/program" "$stage/readme.c" $(pkg-config --cflags --libs tvi) -lm
"$stage/program" | grep "^q = (0.256821, -0.685955), energy -0.680000000000, error "
[ ! -e "$stage/asked" ] || { cat "$stage/asked"; exit 1; }
