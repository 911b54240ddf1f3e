#!/bin/sh
# tables.sh BUILD
# bench/tables.sh on a document of its own: it accepts what is right, and tells each kind of what is not.
set -u
work=$1/check/tables
rm -rf "$work" && mkdir -p "$work/made" || exit 1
failed=0

cat >"$work/made/toy.md" <<'END'
| method | N | error | order (error) | ms (time) | section (chaotic) |
|---|---|---|---|---|---|
| start | 2 | 1.0e-05 | 4.0 (3.0e-07) | 17 | 1 |
| end | 3 | 4.0e-13 | - | 12 | 2 |
END
sed 's/17/170/; s/| 1 |$/| 99 |/; s/1\.0e-05/1.9e-05/; s/4\.0e-13/9.0e-14/' "$work/made/toy.md" >"$work/table"

# document TABLE: with it
document() {
    { echo 'Before.'; echo '<!-- table: toy.md : make toy -->'; cat "$1"; echo '<!-- end -->'; echo 'After.'; } >"$work/toy.md"
}
tables() { MAKE=true bench/tables.sh "$1" "$work/made" "${2:-all}" "$work/toy.md" >"$work/output" 2>&1; }

# expect STATUS TEXT: of a verification of the document
expect() {
    tables verify
    status=$?
    if [ $status -ne "$1" ] || ! grep -q -e "$2" "$work/output"; then
        echo "status $status where $1 is right, or no \"$2\":"
        cat "$work/toy.md" "$work/output"
        failed=1
    fi
}

# changed FROM TO TEXT: the table with FROM replaced is refused with TEXT
changed() {
    sed "s/$1/$2/" "$work/table" >"$work/changed"
    cmp -s "$work/table" "$work/changed" && { echo "nothing to replace: $1"; failed=1; }
    document "$work/changed"
    expect 1 "$3"
}

document "$work/table"
expect 0 'verify: 1 tables and pictures'
changed '1\.9e-05' '2.1e-05' 'toy.md:5: column "error": written 2.1e-05, made 1.0e-05'
changed '1\.9e-05' '0.4e-05' 'column "error"'
changed '1\.9e-05' '-1.0e-05' 'column "error"'
changed '9\.0e-14' '2.1e-12' 'toy.md:6: column "error"'
changed '4\.0 (3' '1.9 (3' 'column "order (error)"'
changed '3\.0e-07' '6.1e-07' 'column "order (error)"'
changed ' - ' ' 1 ' 'toy.md:6: column "order (error)": written 1, made -'
changed '| 2 |' '| 5 |' 'column "N"'
changed '| start' '| midpoint' 'written midpoint, made start'
changed '| end' '| extra | - | - | - | - | - |\
| end' 'the made table ends before this line'
changed '| 3 | .*' '| 3 |' 'another number of columns'
changed 'ms (time)' 'ms' 'another head'
sed '$d' "$work/table" >"$work/changed" && document "$work/changed"
expect 1 'the made table goes on'

document "$work/table" && sed -i '/end -->/d' "$work/toy.md"
expect 1 'a table without'
document "$work/table" && sed -i 's/table: toy.md :/table: toy.md/' "$work/toy.md"
expect 1 'not a line of a table'
document "$work/table" && sed -i 's/table: toy/table: none/' "$work/toy.md"
expect 1 'wrote no'
document "$work/table" && sed -i '/<!--/d' "$work/toy.md"
expect 1 'no tables'

document "$work/changed" && tables replace && cp "$work/toy.md" "$work/replaced"
document "$work/made/toy.md"
cmp "$work/replaced" "$work/toy.md" || failed=1
# a picture, and a table that another target makes
picture() { printf '%s\n' '' '<!-- picture: toy.png : make toy -->' "$1" >>"$work/toy.md"; }
echo drawn >"$work/made/toy.png" && picture '![Toy](new.png)'
rm -f "$work/new.png" && tables replace toy && cmp "$work/made/toy.png" "$work/new.png" || failed=1
document "$work/changed" && sed -i 's/make toy/make another/' "$work/toy.md" && picture '![Toy](new.png)'
cp "$work/toy.md" "$work/before" && tables replace toy && cmp "$work/before" "$work/toy.md" || failed=1
(export WITHOUT=another && tables replace) && cmp "$work/before" "$work/toy.md" || failed=1
tables replace none && failed=1
picture 'no picture'
expect 1 'a picture without its line'
document "$work/table" && echo '<!-- picture: toy.png -->' >>"$work/toy.md"
expect 1 'not a line of a picture'

document "$work/made/toy.md"
sed -i 's/make toy/make toy (times only)/; s/1\.0e-05/7/' "$work/toy.md"
expect 0 'verify: 1 tables'
[ $failed -eq 0 ] && echo 'tables: all as expected'
exit $failed
