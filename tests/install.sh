#!/bin/sh
# install.sh STAGE VERSION
# Installs below STAGE/usr, and in the manner of a package below STAGE/package, which is then moved; builds the programs of
# tests/consumer in C and in C++ with what is installed, by pkg-config and by CMake, shared and static; uninstalls. Asks
# Debian for packages only where it may.
# CC, CXX, MAKE, PYTHON, BUILD and STRICT come from the environment.
set -eu
stage=$1 version=$2
here=$(dirname "$0")
consumer=$(cd "$here/consumer" && pwd)
fail() {
    echo "install.sh: $*" >&2
    exit 1
}
install() { $MAKE -s --no-print-directory "$@"; }

lib=lib # of the libraries, below the prefix

# run PROGRAM PREFIX: a program of the shared library, which must be that of PREFIX
run_shared() {
    LD_LIBRARY_PATH="$2/$lib" ldd "$1" | grep -F "$2/$lib/$(readlink "$2/$lib/libtvi.so")"
    LD_LIBRARY_PATH="$2/$lib" "$1"
}
run_static() {
    ! ldd "$1" | grep libtvi || fail "$1 is not static"
    "$1"
}

# by_pkg_config PREFIX PKG_CONFIG...
by_pkg_config() {
    prefix=$1
    shift
    test "$("$@" --modversion tvi)" = "$version"
    out=$stage/pkg-config
    rm -rf "$out" && mkdir -p "$out"
    # shellcheck disable=SC2046,SC2086  # flags are words
    for language in c cpp; do
        [ $language = c ] && compiler="$CC -std=c11" || compiler="$CXX -std=c++11"
        $compiler $STRICT -o "$out/shared_$language" "$consumer/consumer.$language" $("$@" --cflags --libs tvi)
        run_shared "$out/shared_$language" "$prefix"
        $compiler $STRICT -o "$out/alone_$language" "$consumer/consumer.$language" $("$@" --cflags --libs tvi-static)
        run_static "$out/alone_$language"
    done
}

configure() { CMAKE_PREFIX_PATH=$1 cmake -S "$consumer" -B "$2" $3 -DCMAKE_C_COMPILER="$CC" -DCMAKE_CXX_COMPILER="$CXX" \
    -DCMAKE_C_FLAGS="$STRICT" -DCMAKE_CXX_FLAGS="$STRICT"; }

# by_cmake PREFIX shared|static...
by_cmake() {
    prefix=$1
    shift
    for component; do
        out=$stage/cmake/$component
        rm -rf "$out"
        configure "$prefix" "$out" -DCOMPONENT="${component#shared}"
        cmake --build "$out"
        for language in c cpp; do "run_$component" "$out/consumer_$language" "$prefix"; done
    done
}

# the module of Python, which takes the library that is installed with it
by_python() {
    module=$(find "$1" -type d -path '*/python*/*-packages/tvi')
    PYTHONPATH=${module%/tvi} TVI_LIBRARY="" "$PYTHON" -c "
import tvi
assert tvi.Integrator(tvi.potential(1, lambda q: q[0]**2), [1], p=0).integrate(0.1, 10) and tvi.__version__ == '$version'
assert '$1/$lib/libtvi.so.$version' in open('/proc/self/maps').read() and tvi.__file__.startswith('$1')" ||
        fail "the module of Python"
}

# what there is not: another version, another component
refused_by_cmake() {
    for wrong in -DWANTED=0.1 -DWANTED=0.3 -DWANTED=1.0 -DWANTED="$version.1" -DCOMPONENT=gpu; do
        ! configure "$1" "$stage/cmake/refused" $wrong >"$stage/refused.log" 2>&1 || fail "CMake takes $wrong"
        grep -qE 'version|components' "$stage/refused.log" || fail "CMake does not say what is wrong with $wrong"
        rm -rf "$stage/cmake/refused"
    done
}

# each function that users call has a manual page which names it, and no page has a fault
manual() {
    backspace=$(printf '\b')
    cd "$1/share/man"
    mandoc -Tlint -Wwarning man3/tvi.3 man3/jet.3 || fail "faults in the manual pages"
    for page in tvi jet; do
        mandoc -Tutf8 man3/$page.3 | sed "s/.$backspace//g" >"$stage/$page.txt"
        ! grep -n '^.\{81,\}' "$stage/$page.txt" || fail "$page(3) is wider than 80 columns"
        grep -q '^EXAMPLE' "$stage/$page.txt" || fail "$page(3) has no example"
    done
    swallowed=$(awk '/^ +TVI_E/ { next } /^ +.*[:;.] +TVI_E[A-Z]+( |:|$)/' "$stage/tvi.txt")
    [ -z "$swallowed" ] || fail "statuses that have no line of their own: $swallowed"
    for name in $(nm -D --defined-only "$1/lib/libtvi.so" | awk '!/jet_record/ { print $3 }') jet_mul jet_sin tvi_bodies_potential tvi_orbit_of; do
        mandoc "man3/$name.3" | grep -q "$name(" || fail "no manual page with $name"
    done
    cd - >/dev/null
}

# the links of the pages lead to what is installed with them
pages() {
    cd "$1/share/doc/tvi"
    for page in *.md examples/README.md python/README.md; do
        for link in $(grep -oE '\]\([^)#]+' "$page" | sed 's/^](//' | grep -v '^http'); do
            [ -e "$(dirname "$page")/$link" ] || fail "$page has a link to $link, which is not installed"
        done
    done
    cd - >/dev/null
}

# Root's make asks apt-get for what it lacks, and no make does where a packager says DEPS=0 or has DESTDIR: it names it.
# SLEEF, without which all works, is then not missed.
packages() {
    fake=$stage/fake
    mkdir "$fake"
    echo 'exit 1' >"$fake/pkg-config"
    echo 'echo 0' >"$fake/id"
    echo "echo \"\$@\" >>'$fake/asked'" >"$fake/apt-get"
    chmod +x "$fake"/*
    lacking="env -u MAKEFLAGS -u DEPS -u DESTDIR PATH=$fake:$PATH $MAKE -s PREFIX=$stage/none"
    $lacking need-library
    grep -q 'install .*liblapack-dev.*libsleef-dev' "$fake/asked" || fail "root's make asks for no packages"
    rm "$fake/asked"
    for way in 'DEPS=0 need-library' 'DEPS=0 install' "DESTDIR=$stage/none install" 'DEPS=0 need-bench'; do
        ! $lacking $way 2>"$fake/missing" || fail "make $way goes on without what it needs"
        grep '^Missing: .*libblas-dev' "$fake/missing" || fail "make $way does not say what is missing"
        ! grep libsleef-dev "$fake/missing" || fail "make $way misses SLEEF"
        [ ! -e "$fake/asked" ] || fail "make $way asks for packages"
    done
}

rm -rf "$stage"
mkdir -p "$stage/usr/lib"
packages
echo foreign >"$stage/usr/lib/foreign"
install install PREFIX="$stage/usr" DESTDIR=
by_pkg_config "$stage/usr" env PKG_CONFIG_PATH="$stage/usr/lib/pkgconfig" pkg-config
by_cmake "$stage/usr" shared static
refused_by_cmake "$stage/usr"
by_python "$stage/usr"
manual "$stage/usr"
pages "$stage/usr"
install uninstall PREFIX="$stage/usr" DESTDIR= >"$stage/uninstalled"
grep -q "^Removing tvi from $stage/usr" "$stage/uninstalled" || fail "uninstall does not say from where"
left=$(cd "$stage/usr" && find . ! -type d -o -name 'tvi*')
test "$left" = ./lib/foreign || fail "uninstall leaves $left"
install uninstall PREFIX="$stage/usr" DESTDIR= | grep -q "^No tvi is below $stage/usr" || fail "nothing is uninstalled silently"

# as a package, with the libraries in a folder of the architecture: nothing outside, nothing that knows where it was
# staged, and it works where it is moved to
machine=$($CC -print-multiarch)
lib=lib${machine:+/}${machine:-64}
install install PREFIX=/opt/tvi LIBDIR=/opt/tvi/$lib DESTDIR="$stage/package"
test "$(ls "$stage/package")" = opt
! grep -rlF "$stage" "$stage/package" || fail "the package knows where it was staged"
grep -x 'prefix=/opt/tvi' "$stage/package/opt/tvi/$lib/pkgconfig/tvi.pc"
mv "$stage/package" "$stage/moved"
moved=$stage/moved/opt/tvi
by_pkg_config "$moved" env PKG_CONFIG_SYSROOT_DIR="$stage/moved" PKG_CONFIG_PATH="$moved/$lib/pkgconfig" pkg-config
by_cmake "$moved" shared
by_python "$moved"
install uninstall PREFIX=/opt/tvi LIBDIR=/opt/tvi/$lib DESTDIR="$stage/moved"
! install install PREFIX=/opt/tvi LIBDIR=/usr/lib DESTDIR="$stage/outside" 2>/dev/null || fail "LIBDIR outside of PREFIX"
test -z "$(find "$stage/moved" ! -type d -o -name 'tvi?*')" || fail "uninstall leaves files in a package"
