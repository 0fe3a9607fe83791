#!/bin/sh
# Which part of all instructions of a render the interior list takes: the lines of src/nest, wherever they were inlined.
# usage: instructions.sh MENISCUS SCENE...     a program with debug information (make VARIANT=profile); needs valgrind
# SPDX-License-Identifier: Apache-2.0
set -eu
program=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for scene; do
  valgrind --tool=callgrind --callgrind-out-file="$folder/out" "$program" render "$scene" --size 64x48 -s 16 -j1 -q \
    -o "$folder/picture.exr" 2> "$folder/log" || { cat "$folder/log"; exit 1; }
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
