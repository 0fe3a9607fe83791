#!/bin/sh
# Makes what comes from the tables anew: the generated sections of the manual pages, the files for editors and the dictionary
# for fuzzing; or with --check only says which are stale.
# usage: man/refresh.sh MENISCUS [--check]
# SPDX-License-Identifier: Apache-2.0
set -eu
program=$1
mode=${2:-}
root=$(dirname "$0")/..
fresh=$(mktemp)
trap 'rm -f "$fresh"' EXIT
stale=0

refresh() { # FILE ARGUMENT...: what the program prints for these
    file=$1
    shift
    "$program" "$@" > "$fresh"
    cmp -s "$fresh" "$file" && return
    if [ "$mode" = --check ]; then
        echo "${file#"$root"/} is stale: run make man" >&2
        stale=1
    else
        cat "$fresh" > "$file"
        echo "${file#"$root"/}"
    fi
}
for page in "$root"/man/*.[157]; do refresh "$page" manual "$page"; done
refresh "$root/grammar/meniscus.vim" editor vim
refresh "$root/grammar/meniscus.tmLanguage.json" editor textmate
refresh "$root/grammar/meniscus.dict" editor dictionary
exit $stale
