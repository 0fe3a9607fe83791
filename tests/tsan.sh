#!/bin/sh
# Renders scenes with four threads under ThreadSanitizer, as many samples everywhere, and where they are needed; any race of
# the program's own is a failure. `make tsan`. history_size: stacks that are forgotten cannot be told from Embree's own.
# usage: tests/tsan.sh MENISCUS (of the variant tsan) SCENE...    a SCENE may have options after it
# SPDX-License-Identifier: Apache-2.0
set -u
cd "$(dirname "$0")/.." || exit 2
program=$1
shift
folder=$(mktemp -d) || exit 2
trap 'rm -rf "$folder"' EXIT
n_failed=0
for scene in "$@"; do
    for way in "-s 4" "-s 8 --noise 20%" "-s 24 --adaptive on --caustics on"; do
        # shellcheck disable=SC2086
        TSAN_OPTIONS="suppressions=tests/tsan.supp exitcode=66 history_size=7" "$program" render $scene --size 40x30 $way -j4 \
            -o "$folder/picture.####.exr" > "$folder/log" 2>&1
        status=$?
        if [ "$status" = 0 ]; then echo "tsan: $scene $way: no race"; else
            n_failed=$((n_failed + 1))
            echo "tsan: $scene $way: status $status"
            cat "$folder/log"
        fi
    done
done
exit "$n_failed"
