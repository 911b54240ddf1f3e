#!/bin/sh
# floors.sh: the includes between the floors of the house, and how many; fails on one that goes up. A file includes what
# stands on its own floor and on those to the right of it. And nothing in src/ asks which method it is: the values of
# tvi_method and tvi_expansion stand in descriptors, and nowhere else.
set -eu
floors='run events integrator generating galerkin compiled method system algebra jets'

# where a file stands, and where what it includes: tvi.h and its like are what the systems are made of, jet.h belongs to the jets
grep -oE '^ *# *include "[^"]*"' src/*/*.[ch] ad/*.[ch] | sed 's/:[^"]*"/ /; s/"//' | while read -r file header; do
    case $file in ad/*) from=jets ;; *) from=${file#src/} from=${from%%/*} ;; esac
    case $header in tvi*.h) to=algebra ;; */*) to=${header%%/*} ;; *) to=jets ;; esac
    echo "$file $from $to"
done | awk -v order="$floors" '
    BEGIN { count = split(order, name); for (i = 1; i <= count; i++) height[name[i]] = count - i + 1 }
    $2 != $3 { uses[$2 " -> " $3]++ }
    !height[$2] || !height[$3] || height[$3] > height[$2] { print $1 " goes up, to " $3; failed = 1 }
    END { for (arrow in uses) print uses[arrow], arrow | "sort -k 2"; close("sort -k 2"); exit failed || !NR }'
if grep -nE '^ *# *include "[^"]*\.c"' src/*/*.[ch] ad/*.[ch] bench/*/*.[ch] tests/*/*.[ch]; then exit 1; fi

values='TVI_(TYPE[123]|POINCARE|TAYLOR|STORMER_VERLET|AT_[A-Z_]+)'
! grep -nE "\\b$values\\b" src/*/*.[ch] | grep -vE "[{ ]\\.(method|expansion) = $values,\$"
