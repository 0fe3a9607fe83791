#!/bin/sh
# Renders scenes with four threads under ThreadSanitizer; any race of the program's own is a failure. `make tsan`.
# usage: tests/tsan.sh MENISCUS (of the variant tsan) SCENE...
# SPDX-License-Identifier: Apache-2.0
set -u
cd "$(dirname "$0")/.." || exit 2
program=$1
shift
folder=$(mktemp -d) || exit 2
trap 'rm -rf "$folder"' EXIT
n_failed=0
for scene in "$@"; do
    TSAN_OPTIONS="suppressions=tests/tsan.supp exitcode=66" "$program" render "$scene" --size 40x30 -s 4 -j4 \
        -o "$folder/picture.####.exr" > "$folder/log" 2>&1
    status=$?
    if [ "$status" = 0 ]; then echo "tsan: $scene: no race"; else
        n_failed=$((n_failed + 1))
        echo "tsan: $scene: status $status"
        cat "$folder/log"
    fi
done
exit "$n_failed"
