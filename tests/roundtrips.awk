# roundtrips.awk - finds where gcc would drop a rounding: it makes vectors of neighbours, and up to version 12 takes what
# rounds a vector of doubles to float and back for nothing at all (see vec3_rounded in src/base/vec3.h).
# usage: awk -f tests/roundtrips.awk DUMP...    of -fdump-tree-slp1, -fdump-tree-slp2 and -fdump-tree-vect
# Prints each place; its status is 1 if there is one, and 2 if there is nothing to look at.
# SPDX-License-Identifier: Apache-2.0
/^;; Function / {
    name = $3
    split("", of_doubles)
}
/^ +[^ ]+ = \(vector\([0-9]+\) float\) / {
    of_doubles[$1] = 1
}
/^ +[^ ]+ = \(vector\([0-9]+\) double\) / {
    source = $NF
    sub(/;$/, "", source)
    if (source in of_doubles && !((FILENAME, name) in seen)) {
        seen[FILENAME, name] = 1
        printf "%s: %s: rounds neighbouring doubles to float and back, which gcc leaves out: use vec3_rounded\n", FILENAME, name
        found = 1
    }
}
END {
    if (NR == 0) exit 2
    exit found
}
