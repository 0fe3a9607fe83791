#!/bin/sh
# Golden pictures: each scene of tests/render/list is rendered small and compared with its reference.
# usage: tests/render/run.sh MENISCUS [--make NAME]   --make renders the reference anew (many samples); never done by itself
# A line of the list: NAME, the largest root mean square error allowed, the scene, further options, more samples than 32 among
# them. The limits are the noise that was measured, and four tenths more. Nothing is denoised, whatever a scene says, and in
# references every sample is where it was found. The mean may be off by 2 %. A missing reference fails.
# SPDX-License-Identifier: Apache-2.0
set -u
case $1 in /*) program=$1 ;; *) program=$PWD/$1 ;; esac
folder=$(cd "$(dirname "$0")" && pwd)
cd "$folder/../.." || exit 2
scratch=$(mktemp -d) || exit 2
trap 'rm -rf "$scratch"' EXIT
n_passed=0 n_failed=0
grep -v '^#' "$folder/list" > "$scratch/list"
while read -r name limit scene options; do
    [ -n "$name" ] || continue
    reference=$folder/$name.exr
    if [ "${2:-}" = --make ]; then
        [ "$name" = "${3:-}" ] || continue
        # shellcheck disable=SC2086
        "$program" render "$scene" $options --size 64x48 --spp 4096 --seed 13 --fireflies keep --denoise off --half -q -o "$reference" < /dev/null || exit 1
    fi
    # shellcheck disable=SC2086
    "$program" render "$scene" --spp 32 $options --size 64x48 --seed 1 --denoise off -q -o "$scratch/now.exr" < /dev/null 2> "$scratch/err"
    measured=$("$program" compare "$scratch/now.exr" "$reference" --max-rmse "$limit" < /dev/null 2>> "$scratch/err")
    compared=$?
    # the mean over the picture is far less noisy than its pixels: 2 % of green
    drift=$(echo "$measured" | awk '/^mean of A/ { a = $5 } /^mean of B/ { b = $5 } END { d = (a - b) / b; if (d < 0) d = -d; print 100 * d }')
    steady=$(echo "$drift" | awk '{ print $1 <= 2 ? "yes" : "no" }')
    if [ $compared -eq 0 ] && [ "$steady" = yes ] && [ ! -s "$scratch/err" ]; then n_passed=$((n_passed + 1)) verdict=ok; else
        n_failed=$((n_failed + 1)) verdict='not ok'
    fi
    echo "$name: $verdict, $(echo "$measured" | sed -n 's/^rmse *\([^ ]*\).*/rmse \1/p') of at most $limit allowed, mean off by $drift %"
    cat "$scratch/err"
done < "$scratch/list"
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
