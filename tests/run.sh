#!/bin/sh
# Runs test programs and scripts, shows the figures that they print, and adds up what passed.
# usage: tests/run.sh MENISCUS PROGRAM... ; a PROGRAM is a cmocka program, or a script that ends with "N passed, N failed"
# The last line is "N passed, N failed"; the exit status is 1 when anything failed.
# SPDX-License-Identifier: Apache-2.0
set -u
meniscus=$1
shift
n_passed=0 n_failed=0
log=$(mktemp) || exit 2
trap 'rm -f "$log"' EXIT
for program in "$@"; do
    name=$(basename "$program")
    before=$(date +%s)
    case $program in
    *.sh) sh "$program" "$meniscus" > "$log" 2>&1; status=$?
        passed=$(sed -n 's/^\([0-9]*\) passed, [0-9]* failed$/\1/p' "$log" | tail -1)
        failed=$(sed -n 's/^[0-9]* passed, \([0-9]*\) failed$/\1/p' "$log" | tail -1) ;;
    *) CMOCKA_MESSAGE_OUTPUT=STDOUT "$program" > "$log" 2>&1; status=$?
        passed=$(grep -c '^\[       OK \]' "$log")
        failed=$(grep -c '^\[  FAILED  \] [a-z_0-9]*$' "$log")
        # a list of failures repeats each of them, and a crash prints none
        failed=$((failed / 2)) ;;
    esac
    [ -n "$passed" ] || passed=0
    [ -n "$failed" ] || failed=0
    [ "$status" -eq 0 ] || [ "$failed" -gt 0 ] || failed=1
    [ "$status" -ne 0 ] || [ "$((passed + failed))" -gt 0 ] || failed=1 # a test that tests nothing
    n_passed=$((n_passed + passed)) n_failed=$((n_failed + failed))
    echo "$name: $passed passed, $failed failed, $(($(date +%s) - before)) s"
    if [ "$failed" -gt 0 ]; then
        sed -n '/^not ok/,/^ok/p' "$log" | sed 's/^/    /' | head -60 # of many tests these may be long gone by the end
        sed 's/^/    /' "$log" | tail -60
    else
        grep -vE '^\[|^ok |^[0-9]+ passed|^$' "$log" | sed 's/^/    /' | head -60
    fi
done
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
