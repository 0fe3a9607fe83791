#!/bin/sh
# Makes the files for editors and the dictionary for fuzzing anew, or with --check only says which are stale.
# usage: grammar/refresh.sh MENISCUS [--check]
# SPDX-License-Identifier: Apache-2.0
set -eu
program=$1
mode=${2:-}
folder=$(dirname "$0")
fresh=$(mktemp)
trap 'rm -f "$fresh"' EXIT
stale=0
for pair in vim:meniscus.vim textmate:meniscus.tmLanguage.json dictionary:meniscus.dict; do
    file=$folder/${pair#*:}
    "$program" editor "${pair%%:*}" > "$fresh"
    cmp -s "$fresh" "$file" && continue
    if [ "$mode" = --check ]; then
        echo "$file is stale: run grammar/refresh.sh" >&2
        stale=1
    else
        cat "$fresh" > "$file"
        echo "$file"
    fi
done
exit $stale
