#!/bin/sh
# fragments.sh FOLDER PAGE.md...
# Builds and runs the fragments of C of the pages below the folder, with warnings as errors: first beside an orbit() that has
# no code, then beside the orbit.c that a fragment of docs/compiled.md has written, by the command of that page. CC, LIBRARY
# and STRICT come from the environment.
set -eu
folder=$1
shift
root=$PWD
rm -rf "$folder"
mkdir -p "$folder"
export XDG_CACHE_HOME="$folder/cache"
unset TVI_ISA # the page's command compiles for the machine at hand, and that is refused where less is allowed
awk -f tests/fragments.awk "$@" >"$folder/fragments.c"
cd "$folder"
flags="-std=c11 $STRICT -I$root/include"
printf '#include <tvi.h>\nconst tvi_compiled *orbit(void);\nconst tvi_compiled *orbit(void) { return NULL; }\n' >none.c
# shellcheck disable=SC2086  # flags are words
$CC $flags -Wno-unused-result -o fragments fragments.c none.c $LIBRARY
./fragments
sh -c "$(sed -n 's/^    \(cc .* -c orbit.c\)$/\1/p' "$root/docs/compiled.md")"
# shellcheck disable=SC2086
$CC $flags -Wno-unused-result -o fragments fragments.c orbit.o $LIBRARY
./fragments >again.out
test "$(grep -c ': compiled$' again.out)" = 2
