#!/bin/sh
# Small renders of scenes by two builds of the program are the same files, byte for byte.
# usage: tests/same-bits.sh MENISCUS OTHER SCENE...    either may be a command with words, as "qemu-aarch64 -L FOLDER MENISCUS"
# SPDX-License-Identifier: Apache-2.0
set -u
cd "$(dirname "$0")/.." || exit 2
one=$1 other=$2
shift 2
folder=$(mktemp -d) || exit 2
trap 'rm -rf "$folder"' EXIT
n_passed=0 n_failed=0
for scene in "$@"; do
    for way in "--size 40x30 -s 4 --aov all" "--size 24x18 -s 24 --adaptive on --caustics on"; do
        # a scene of several frames writes several files
        rm -rf "$folder/one" "$folder/other" && mkdir "$folder/one" "$folder/other"
        said=''
        for build in one other; do
            eval "program=\$$build"
            # shellcheck disable=SC2086,SC2154
            $program render "$scene" $way --frames 1 -q -o "$folder/$build/picture.exr" < /dev/null > "$folder/log" 2>&1 ||
                said="$program: $(cat "$folder/log")"
        done
        for picture in "$folder"/one/*; do
            # shellcheck disable=SC2086
            cmp -s "$picture" "$folder/other/${picture##*/}" ||
                said="$said $($one compare "$picture" "$folder/other/${picture##*/}" 2>&1 < /dev/null | tr -s '\n ' ', ')"
        done
        if [ -z "$said" ]; then n_passed=$((n_passed + 1)) && echo "$scene $way: the same"; else
            n_failed=$((n_failed + 1)) && echo "$scene $way: not the same: $said"
        fi
    done
done
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ] && [ "$n_passed" -gt 0 ]
