#!/bin/sh
# src/README.md names every file of src, no file that is not there, and every source that the code cites.
# usage: tests/tour.sh [MENISCUS]
# SPDX-License-Identifier: Apache-2.0
set -u
cd "$(dirname "$0")/../src" || exit 2
n_passed=0 n_failed=0
for file in */*; do
    # a header is covered by the line of its source file
    stem=${file%.*}
    if grep -qE "\`$stem(\.[a-z]+)?\`" README.md; then n_passed=$((n_passed + 1)); else
        n_failed=$((n_failed + 1))
        echo "not ok - README.md does not name $file"
    fi
done
for name in $(grep -oE '`[a-z]+/[a-z0-9_]+(\.[a-z]+)?`' README.md | tr -d '`' | sort -u); do
    for match in "$name" "$name".*; do [ -e "$match" ] && break; done
    if [ -e "$match" ]; then n_passed=$((n_passed + 1)); else
        n_failed=$((n_failed + 1))
        echo "not ok - README.md names $name, which is not there"
    fi
done
for key in $(grep -rohE '\[[A-Z][A-Za-z]+[0-9]{2}\]' --include='*.[ch]' . | tr -d '[]' | sort -u); do
    if grep -qF "**[$key]**" README.md; then n_passed=$((n_passed + 1)); else
        n_failed=$((n_failed + 1))
        echo "not ok - README.md does not say what [$key] is"
    fi
done
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
