#!/bin/sh
# Replays what the fuzzers once found, and their seeds, without a fuzzer: tests/fuzz/corpus/NAME/.
# usage: tests/fuzz.sh MENISCUS     the entry points stand in fuzz/ beside it
# SPDX-License-Identifier: Apache-2.0
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "$(dirname "$1")" && pwd)
seeds=$(mktemp -d) || exit 2
trap 'rm -rf "$seeds"' EXIT
TMPDIR=$seeds
export TMPDIR
"${PYTHON:-python3}" "$root/tests/fuzz/seeds.py" "$seeds" "$1" || exit 2
n_passed=0 n_failed=0
for source in "$root"/tests/fuzz/*.c; do
    name=$(basename "$source" .c)
    [ "$name" != replay ] || continue
    mkdir -p "$seeds/$name" # some corpus is empty, and not there
    [ ! -d "$root/tests/fuzz/corpus/$name" ] || cp "$root/tests/fuzz/corpus/$name"/* "$seeds/$name" 2> /dev/null
    if find "$seeds/$name" -type f -exec "$build/fuzz/$name" {} + > "$seeds/log" 2>&1; then
        n_passed=$((n_passed + 1))
        echo "fuzz $name: $(cat "$seeds/log")"
    else
        n_failed=$((n_failed + 1))
        echo "not ok - $name"
        tail -20 "$seeds/log" | sed 's/^/#   /'
    fi
done
echo "$n_passed passed, $n_failed failed"
[ $n_failed -eq 0 ]
