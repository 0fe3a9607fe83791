#!/bin/sh
# Which part of all instructions of a render the interior list takes: the lines of src/nest, wherever they were inlined. And
# how many more a path takes where all is opaque but a list is kept; times of so little are lost in the noise of any machine.
# usage: instructions.sh MENISCUS SCENE...     a program with debug information (make VARIANT=profile); needs valgrind
# SPDX-License-Identifier: Apache-2.0
set -eu
program=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# count SAMPLES SCENE OPTION...: renders it, with what ran in $folder/out
count() {
  samples=$1
  shift
  valgrind --tool=callgrind --callgrind-out-file="$folder/out" "$program" render "$@" --size 64x48 -s "$samples" -j1 -q \
    --denoise off -o "$folder/picture.exr" 2> "$folder/log" || { cat "$folder/log"; exit 1; }
}

for scene; do
  count 16 "$scene"
  # Costs stand behind lines fl= (a function's file) and fi= or fe= (of what is inlined in it), files by number once
  # named, which may be at a call (cfi=, cfl=); the line after a call is the callee's.
  awk -v scene="$scene" '
    /^f[lie]=/ { id = $1; sub(/^f[lie]=/, "", id); if (NF > 1) { name[id] = $2 } nest = name[id] ~ /src\/nest\//; next }
    /^cf[il]=/ { id = $1; sub(/^cf[il]=/, "", id); if (NF > 1) { name[id] = $2 } next }
    /^calls=/ { getline; next }
    /^[0-9+*-]/ && NF >= 2 { total += $2; if (nest) list += $2 }
    END { printf "%-32s %8.3f %% of %.0f million instructions are the interior list (goal: 0.4)\n",
          scene, 100 * list / total, total / 1e6 }' "$folder/out"
done

# The rendering alone: what 12 samples take over 4.
total() { awk '/^summary:/ || /^totals:/ { print $2; exit }' "$folder/out"; }
per_path() {
  count 4 tests/bench/room.mns "$@"
  few=$(total)
  count 12 tests/bench/room.mns "$@"
  echo $(($(total) - few)) | awk '{ printf "%.1f", $1 / (64 * 48 * 8) }'
}
for hulls in 1 8; do
  listed=$(per_path -D hulls=$hulls -D opaque=false)
  empty=$(per_path -D hulls=$hulls -D opaque=true)
  echo "$hulls $listed $empty" | awk '{
    printf "opaque objects, a list of %s: %.1f instructions a path, %.1f with an empty list: %.5f x (goal: 1.005)\n",
           $1, $2, $3, $2 / $3 }'
done
