# tools.sh - view, compare, info, completion, version.
# SPDX-License-Identifier: Apache-2.0

begin "compare: equal pictures, different ones, other sizes"
small_scene
run render small.mns -o a.exr
run render small.mns -o b.exr --seed 2
run compare a.exr a.exr --max-rmse 0
exits 0
matches out '^rmse +0$'
run compare a.exr b.exr
exits 0
run compare a.exr b.exr --max-rmse 0
exits 1
says err "the root mean square error"
run compare a.exr b.exr --json --flip
is_json out
says out '"flip"'
run render small.mns -o c.exr --size 8x8
run compare a.exr c.exr
exits 2
run compare a.exr missing.exr
exits 4
end

begin "view: a PNG file, 16 bits, the views there are"
small_scene
run render small.mns -o a.exr -o a.png
run view a.exr -o b.png
exits 0
cmp -s a.png b.png || flunk "view and render make different PNG files"
run view a.exr -o c.png --bits 16 --exposure -1
exits 0
there c.png
run view --list
exits 0
[ -s out ] || flunk "no views"
run view a.exr
exits 2
says err "'--output' is missing"
run view a.exr -o b.exr
exits 2
run view a.exr -o missing/b.png
exits 5
run view a.exr -o b.png --view nothing
exits 2
run view missing.exr -o b.png
exits 4
printf 'no picture' > text.exr
run view text.exr -o b.png
exits 4
end

begin "info: meshes"
cat > tetrahedron.obj <<'MESH'
v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
MESH
run info tetrahedron.obj
exits 0
matches out '^closed +yes$'
matches out '^volume +0\.1666'
run info tetrahedron.obj --json
is_json out
run info missing.ply
exits 4
end

begin "completion scripts"
run completion bash
exits 0
bash -n out || flunk "bash does not read it"
bash -c '. ./out
    COMP_WORDS=(meniscus render --nest); COMP_CWORD=2; _meniscus; [ "${COMPREPLY[*]}" = --nesting ] || exit 1
    COMP_WORDS=(meniscus render --nesting e); COMP_CWORD=3; _meniscus; [ "${COMPREPLY[*]}" = entered ] || exit 2
    COMP_WORDS=(meniscus render --nesting = e); COMP_CWORD=4; _meniscus; [ "${COMPREPLY[*]}" = entered ] || exit 3
    COMP_WORDS=(meniscus ren); COMP_CWORD=1; _meniscus; [ "${COMPREPLY[*]}" = render ] || exit 4
    COMP_WORDS=(meniscus a.mns --see); COMP_CWORD=2; _meniscus; [ "${COMPREPLY[*]}" = --seed ] || exit 5
    COMP_WORDS=(meniscus completion z); COMP_CWORD=2; _meniscus; [ "${COMPREPLY[*]}" = zsh ] || exit 6' ||
    flunk "bash completes wrongly: case $?"
run completion zsh
exits 0
says out '#compdef meniscus'
if command -v zsh > /dev/null; then zsh -n out || flunk "zsh does not read it"; fi
run completion fish
exits 0
if command -v fish > /dev/null; then fish -n out || flunk "fish does not read it"; fi
end

begin "check --json: the facts of the printed reports, each of them"
for scene in "$root"/tests/diag/*.mns "$root"/tests/diag/scene/*.mns; do cp "$scene" .; done
cp -r "$root/tests/diag/parts" "$root"/tests/diag/scene/broken.* .
"$python" "$root/tests/cli/check_json.py" "$program" *.mns > out 2> err
status=$?
exits 0
end

begin "unknown-camera: a camera that the scene does not have"
small_scene
run render small.mns --camera sdie -o x.exr
exits 3
says err '[unknown-camera]'
says err "did you mean 'side'?"
end
