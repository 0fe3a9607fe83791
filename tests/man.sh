#!/bin/sh
# The manual pages are well formed, and what is generated of them and for editors is what the program would make now.
# usage: tests/man.sh MENISCUS
# SPDX-License-Identifier: Apache-2.0
set -u
folder=$(cd "$(dirname "$0")/.." && pwd)
n_passed=0 n_failed=0
if report=$(sh "$folder/man/refresh.sh" "$1" --check 2>&1); then n_passed=1; else
    n_failed=1
    echo "not ok - stale: $report"
fi
for page in "$folder"/man/*.[157]; do
    report=$(mandoc -Tlint -Wwarning "$page" 2>&1)
    if [ -z "$report" ]; then n_passed=$((n_passed + 1)); else
        n_failed=$((n_failed + 1))
        echo "not ok - $report"
    fi
done
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
