#!/bin/sh
# Runs test programs and scripts, shows the figures that they print, and adds up what passed.
# usage: tests/run.sh MENISCUS PROGRAM... ; a PROGRAM is a cmocka program, or a script that ends with "N passed, N failed"
# As many run at a time as there are processors: much of their work has one thread.
# The last line is "N passed, N failed", and before it comes once more what failed; the exit status is 1 when anything did.
# SPDX-License-Identifier: Apache-2.0
set -u

# script PATH MENISCUS: runs a script of tests; what tests/cli has are parts of one
script() {
    case $1 in
    tests/cli/*) sh tests/cli/run.sh "$2" "$(basename "$1" .sh)" ;;
    *) sh "$1" "$2" ;;
    esac
}

# failures PROGRAM STATUS LOG: the names of the tests that failed, each with the last words before it that say why
failures() {
    echo "failed: $1 (status $2)"
    {
        grep -A 4 '^not ok' "$3" | head -40
        sed '/ run\.$/,$d' "$3" | grep -B 5 '^\[  FAILED  \] ' | grep -vE '^(\[ +(RUN|OK) |--$)' | head -40
    } | sed 's/^/    /'
}

# run_one FOLDER MENISCUS PROGRAM: leaves PATH.log and PATH.counts there, each / of PATH a comma (two folders have programs of one
# name), and prints the report as a whole
run_one() {
    name=$(echo "$3" | tr / ,) before=$(date +%s)
    log=$1/$name.log
    case $3 in
    *.sh) script "$3" "$2" > "$log" 2>&1; status=$?
        passed=$(sed -n 's/^\([0-9]*\) passed, [0-9]* failed$/\1/p' "$log" | tail -1)
        failed=$(sed -n 's/^[0-9]* passed, \([0-9]*\) failed$/\1/p' "$log" | tail -1) ;;
    *) CMOCKA_MESSAGE_OUTPUT=STDOUT "$3" > "$log" 2>&1; status=$?
        passed=$(grep -c '^\[       OK \]' "$log")
        failed=$(grep -c '^\[  FAILED  \] [a-z_0-9]*$' "$log")
        # a list of failures repeats each of them, and a crash prints none
        failed=$((failed / 2)) ;;
    esac
    [ -n "$passed" ] || passed=0
    [ -n "$failed" ] || failed=0
    [ "$status" -eq 0 ] || [ "$failed" -gt 0 ] || failed=1
    [ "$status" -ne 0 ] || [ "$((passed + failed))" -gt 0 ] || failed=1 # a test that tests nothing
    echo "$passed $failed" > "$1/$name.counts"
    [ "$failed" -eq 0 ] || failures "$3" "$status" "$log" > "$1/$name.failures"
    {
        echo "$(basename "$3"): $passed passed, $failed failed, $(($(date +%s) - before)) s"
        if [ "$failed" -gt 0 ]; then
            sed -n '/^not ok/,/^ok/p' "$log" | sed 's/^/    /' | head -60 # of many tests these may be long gone by the end
            sed 's/^/    /' "$log" | tail -60
        else
            grep -vE '^\[|^ok |^[0-9]+ passed|^$' "$log" | sed 's/^/    /' | head -60
        fi
    } > "$1/$name.report"
    flock "$1/lock" cat "$1/$name.report" 2> /dev/null || cat "$1/$name.report"
}

if [ "$1" = --one ]; then
    run_one "$2" "$3" "$4"
    exit
fi
meniscus=$1
shift
results=$(mktemp -d) || exit 2
trap 'rm -rf "$results"' EXIT
printf '%s\n' "$@" | xargs -r -n 1 -P "$(nproc)" sh "$0" --one "$results" "$meniscus"
n_passed=0 n_failed=0 n_programs=0
for counts in "$results"/*.counts; do
    read -r passed failed < "$counts"
    n_passed=$((n_passed + passed)) n_failed=$((n_failed + failed)) n_programs=$((n_programs + 1))
done
[ "$n_programs" -eq $# ] || { echo "of $# programs $n_programs were run" >&2; n_failed=$((n_failed + 1)); }
cat "$results"/*.failures 2> /dev/null # of the reports this is far above, and what keeps a part of the output keeps its end
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
