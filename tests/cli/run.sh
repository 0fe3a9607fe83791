#!/bin/sh
# Runs the tests of the command line against one binary, in a scratch folder.
# usage: tests/cli/run.sh MENISCUS [NAME...]     names of the test files, without .sh; default: all
# Each test prints "ok N - name" or "not ok N - name" with what went wrong; the last line is "N passed, N failed".
# SPDX-License-Identifier: Apache-2.0
set -u
[ $# -ge 1 ] || { echo "usage: $0 MENISCUS [NAME...]" >&2; exit 2; }
case $1 in /*) program=$1 ;; *) program=$PWD/$1 ;; esac
shift
[ -x "$program" ] || { echo "$0: no program '$program'" >&2; exit 2; }
folder=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$folder/../.." && pwd)
scratch=$(mktemp -d) || exit 2
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 2
unset OCIO MENISCUS_PATH NO_COLOR CLICOLOR
TERM=dumb
LC_ALL=C
export TERM LC_ALL

n_passed=0 n_failed=0 name='' failed='' is_open=''

# begin NAME: a test; what follows up to end belongs to it
begin() { ended; name=$1 failed='' is_open=yes; rm -rf "$scratch/work"; mkdir "$scratch/work"; cd "$scratch/work" || exit 2; }
flunk() { failed="$failed
# $*"; }
end() {
    is_open=''
    if [ -z "$failed" ]; then
        n_passed=$((n_passed + 1))
        echo "ok $((n_passed + n_failed)) - $name"
    else
        n_failed=$((n_failed + 1))
        echo "not ok $((n_passed + n_failed)) - $name$failed"
        [ -s out ] && sed 's/^/#   out: /' out | head -20
        [ -s err ] && sed 's/^/#   err: /' err | head -20
    fi
}
# a test that nothing ends would count for nothing
ended() { [ -z "$is_open" ] || { flunk "it has no end"; end; }; }
# run ARGUMENT...: the program; leaves the files out and err, and $status
run() {
    "$program" "$@" > out 2> err < /dev/null
    status=$?
    [ $status -lt 129 ] || flunk "died with status $status: meniscus $*"
}
# run_until SECONDS SIGNAL ARGUMENT...: the same, stopped by the signal after so long
run_until() {
    stop_after=$1 stop_by=$2
    shift 2
    timeout -s "$stop_by" --preserve-status "$stop_after" "$program" "$@" > out 2> err
    status=$?
}
# run_till EXPRESSION SIGNAL ARGUMENT...: the same, stopped once its progress, as lines of JSON, matches, however busy the machine is
run_till() {
    till=$1 stop_by=$2
    shift 2
    rm -f err
    env --default-signal=INT "$program" "$@" --progress json > out 2> err & # which a shell's background processes ignore
    child=$!
    await grep -qE -e "$till" err || flunk "its progress never matches: $till"
    kill -"$stop_by" $child || flunk "it has ended already"
    wait $child 2> /dev/null
    status=$?
}
sampling='"samples": [1-9]' # of run_till: after the first sample
following='"photons": [0-9.]*[1-9]' # after the first photons
exits() { [ "$status" -eq "$1" ] || flunk "exit status $status, not $1"; }
# await COMMAND...: waits until the command succeeds, a minute at most, as a loaded machine may need; then it fails
await() {
    for _ in $(seq 1200); do "$@" > /dev/null 2>&1 && return; sleep .05; done
    return 1
}
# says FILE TEXT: FILE (out, err, ...) holds TEXT; says_not: it does not
says() { grep -qF -e "$2" "$1" || flunk "$1 does not say: $2"; }
says_not() { ! grep -qF -e "$2" "$1" || flunk "$1 says: $2"; }
# matches FILE EXPRESSION: a line of FILE matches
matches() { grep -qE -e "$2" "$1" || flunk "$1 has no line like: $2"; }
empty() { [ ! -s "$1" ] || flunk "$1 is not empty"; }
# no_complaint FILE: it says nothing, or only what takes so long, as on a busy machine
no_complaint() { ! grep -qv '^Progress: ' "$1" || flunk "$1 is not empty"; }
there() { [ -s "$1" ] || flunk "$1 was not written"; }
gone() { [ ! -e "$1" ] || flunk "$1 is there"; }
no_leftovers() { for f in *.tmp; do [ "$f" = '*.tmp' ] || flunk "left behind: $f"; done; }
is_json() { "$python" -m json.tool < "$1" > /dev/null 2>&1 || flunk "$1 is not JSON"; }
python=$(command -v python3 || echo false)

# on_terminal TERM ARGUMENT...: runs on a pseudo-terminal, all output to the file out
on_terminal() {
    TERM=$1 "$python" - "$program" "$@" <<'PYTHON' > out
import os, pty, sys
program, arguments = sys.argv[1], sys.argv[3:]
child, fd = pty.fork()
if child == 0:
    os.execv(program, [program] + arguments)
data = b""
try:
    while True:
        block = os.read(fd, 65536)
        if not block:
            break
        data += block
except OSError:
    pass
os.waitpid(child, 0)
sys.stdout.buffer.write(data)
PYTHON
}

# a scene that renders in no time, and one that renders for ever
small_scene() {
    cat > small.mns <<'SCENE'
meniscus 1.0 unit cm
param level = 3 in 1..5 "radius of the water"
medium glass { ior = 1.5  state = solid }
medium water { ior = 1.333  state = liquid }
sphere { center = <0, 5, 0>  radius = 4  interior = glass }
sphere { center = <0, 5, 0>  radius = level  interior = water }
ground { surface = surface { albedo = .5 } }
environment { color = 1 }
camera { from = <0, 10, -30>  to = <0, 5, 0>  fov = 30 }
camera side { from = <30, 10, 0>  to = <0, 5, 0>  fov = 30 }
film { size = <16, 16> }
render { samples = 4 }
SCENE
}
long_scene() {
    small_scene
    sed -e 's/samples = 4/samples = 16777216/' small.mns > long.mns
}
# one that takes a second or two, for checkpoints and slices: caustics, several things in a pixel, single bright samples
kept_scene() {
    cat > kept.mns <<'SCENE'
meniscus 1.0 unit cm
medium glass { ior = 1.5  state = solid }
medium water { ior = 1.333  state = liquid  tint = rgb(.7, .9, .9)  depth = 5cm }
sphere ball { center = <0, 5, 0>  radius = 4  interior = glass }
sphere drop { center = <0, 5, 0>  radius = 3  interior = water }
for (i in 1..12) { sphere { interior = air  radius = .3  center = <4 * rnd(i, 0) - 2, 3 + 4 * rnd(i, 1), 4 * rnd(i, 2) - 2> } }
ground { surface = surface { albedo = .5 } }
sphere lamp { center = <9, 20, -6>  radius = .3  surface = surface { emission = 800  albedo = 0 } }
camera { from = <0, 10, -30>  to = <0, 4, 0>  fov = 30  aperture = 1mm  focus = <0, 5, -4> }
film { size = <40, 30> }
render { samples = 200 }
SCENE
}
# the scenes there are, beside their meshes
all_scenes() {
    cp "$root"/examples/*.mns .
    ln -s "$root/examples/assets" assets
    for scene in "$root"/tests/lang/*.mns; do cp "$scene" "lang_$(basename "$scene")"; done
}
scene_hash() { "$program" check --json "$@" 2> err | grep '"hash": "'; }

# same_flat SCENE OPTION...: SCENE and what dump makes of it have one hash; the text is laid out as fmt would, and is its own dump
same_flat() {
    run dump --flat "$1"
    exits 0
    cp out flat.mns
    hash=$(scene_hash "$@") scene=$1
    [ -n "$hash" ] || flunk "$scene has no hash"
    shift
    [ "$hash" = "$(scene_hash flat.mns "$@")" ] || flunk "$scene has another hash when it is flat"
    run fmt --check flat.mns
    exits 0
    run dump flat.mns
    cmp -s out flat.mns || flunk "the flat text of $scene changes when it is dumped again"
}

if [ $# -eq 0 ]; then
    for part in "$folder"/*.sh; do
        part=$(basename "$part" .sh)
        [ "$part" = run ] || set -- "$@" "$part"
    done
fi
# what the shell says of a test itself, such as of a word that is no command, is a failure: the test would pass without it
for part; do
    . "$folder/$part.sh" 2> "$scratch/complaints"
    ended
    grep -v '^Terminated$' "$scratch/complaints" > "$scratch/shell" || continue # a signal that a test sends is none
    n_failed=$((n_failed + 1))
    echo "not ok $((n_passed + n_failed)) - $part.sh runs without a complaint of the shell"
    sed 's/^/# /' "$scratch/shell"
done
echo "$n_passed passed, $n_failed failed"
[ $n_failed -eq 0 ]
