#!/bin/sh
# abi.sh compare|renew FOLDER LIBRARY.so ABI HEADER...
# Compares what programs that were linked before rely on, the soname and the declarations that abi.awk reads in the
# headers, with the file ABI; or writes that file anew, and prints the lines that are lost, which docs/changes.md has to
# say. CC comes from the environment; FOLDER is for what is made on the way.
set -eu
way=$1 folder=$2 library=$3 abi=$4
shift 4
mkdir -p "$folder"
for header; do echo "#include \"$(cd "$(dirname "$header")" && pwd)/${header##*/}\""; done >"$folder/all.h"
$CC -E "$folder/all.h" >"$folder/all.i"
awk -f "$(dirname "$0")/abi.awk" "$folder/all.i" >"$folder/abi.c"
$CC -std=c11 -Wall -Werror -o "$folder/abi" "$folder/abi.c"
{
    LC_ALL=C objdump -p "$library" | awk '$1 == "SONAME" { print $2 }'
    "$folder/abi"
} >"$folder/abi.txt"

if [ "$way" = compare ]; then
    diff "$abi" "$folder/abi.txt" && exit 0
    echo "The ABI is not that of $abi, where < is what programs know: docs/contributing.md, \"Versions\"; make abi"
    exit 1
fi
grep -vxFf "$folder/abi.txt" "$abi" | sed 's/^/lost: /'
cp "$folder/abi.txt" "$abi"
