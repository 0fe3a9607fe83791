#!/bin/sh
# Makes the generated sections of the manual pages anew, or with --check only says which are stale.
# usage: man/refresh.sh MENISCUS [--check]
# SPDX-License-Identifier: Apache-2.0
set -eu
program=$1
mode=${2:-}
folder=$(dirname "$0")
fresh=$(mktemp)
trap 'rm -f "$fresh"' EXIT
stale=0
for page in "$folder"/*.[157]; do
    "$program" manual "$page" > "$fresh"
    cmp -s "$fresh" "$page" && continue
    if [ "$mode" = --check ]; then
        echo "$page is stale: run make man" >&2
        stale=1
    else
        cat "$fresh" > "$page"
        echo "$page"
    fi
done
exit $stale
