#!/bin/sh
# replace.sh SCENE HEADER NEW: the header with the paragraph of one scene's reference replaced by NEW, or added.
set -eu
awk -v name="reference_$1[" -v new="$3" '
    function put(text) { printf("%s%s\n", printed++ ? "\n" : "", text) }
    BEGIN { RS = ""; getline one < new }
    index($0, name) { put(one); done = 1; next }
    /^#endif/ && !done { put(one) }
    { put($0) }' "$2"
