# tools.sh - view, compare, info, bench, completion, version.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "info: several files, each with its name in front"
small_scene
run render small.mns -o a.exr -q
run view a.exr -o b.png
run info a.exr b.png
exits 0
matches out '^file +a\.exr$'
matches out '^file +b\.png$'
matches out '^$'
run info a.exr b.png --json
is_json out
[ "$(grep -c '"file": ' out)" -eq 2 ] || flunk "not two files"
run info a.exr
says_not out "file  "
run info a.exr gone.png
exits 4
says err "cannot read 'gone.png'"
end

begin "view: several pictures are a sheet, with their names"
small_scene
for i in 1 2 3; do run render small.mns -o "glass-$i.exr" --seed $i -q --aov depth; done
run view glass-1.exr glass-2.exr glass-3.exr -o sheet.png --columns 3
exits 0
run info sheet.png
wide=$(sed -n 's/^width *//p' out)
run view glass-?.exr -o sheet.png --columns 1
run info sheet.png
narrow=$(sed -n 's/^width *//p' out)
[ "${wide:-0}" -gt "$((2 * ${narrow:-9999}))" ] || flunk "three columns are $wide wide, one is $narrow"
run view glass-1.exr glass-2.exr --layer depth -o depth.png
exits 0
says err "remark: depth: black is"
run view glass-1.exr sheet.png --layer depth -o depth.png
exits 4
says err "'sheet.png': the picture has no layer 'depth'"
run view glass-1.exr gone.exr -o sheet.png
exits 4
says err "cannot read 'gone.exr'"
run view glass-1.exr sheet.png -o sheet.png
exits 2
says err "is both what is viewed and the output"
run view glass-1.exr --columns 2 -o sheet.png
exits 2
says err "'--columns' is about a sheet of several pictures"
end

begin "compare --crop: a part of both, or a part that was rendered with the whole"
cat > ball.mns <<'SCENE'
meniscus 1.0 unit mm
sphere { surface = surface { albedo = .3 } }
environment { }
camera { from = <0, 0, 5> }
film { size = <16, 12> }
render { samples = 4 }
SCENE
run render ball.mns -q -o whole.exr
run render ball.mns -q -o part.exr --crop 4,3,12,9
run compare part.exr whole.exr --max-rmse 0
exits 1
run compare part.exr whole.exr --crop 4,3,12,9 --max-rmse 0
exits 0
run compare part.exr whole.exr --crop 25%,25%,75%,75% --max-rmse 0
exits 0
run compare part.exr whole.exr --crop 12,9,16,12
matches out '^largest .* at 1[2-5],(9|1[01])$'
run compare part.exr whole.exr --crop 4,3,4,9
exits 2
says err "holds no pixel"
end

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
run view a.exr -o a.png
run compare a.png a.exr
exits 0
says err "a.png is made for a display, and a.exr has light as it is"
says err "meniscus view a.exr -o FILE.png"
run compare a.png a.png
says_not err "display"
run compare a.exr missing.exr
exits 4
end

begin "quiet: what prints figures, or nothing but what it is for, takes -q, too"
small_scene
run render small.mns -o a.exr -q
run compare a.exr a.exr -q
exits 0
empty out
empty err
run compare a.exr a.exr -q --json
is_json out
run view -q a.exr -o a.png
exits 0
empty err
run params -q small.mns
says out level
run dump -q --flat small.mns
exits 0
says out sphere
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
run view a.exr -o d.png --exposure -1
run render small.mns -o e.exr -o e.png --exposure -1
run compare a.exr e.exr
matches out '^rmse +0$'
cmp -s d.png e.png || flunk "view and render expose otherwise"
run render small.mns -o f.png --set film.exposure=-1
cmp -s d.png f.png || flunk "the scene's exposure is another than that of --exposure"
run render small.mns -o g.png --set film.exposure=-1 --exposure 0
cmp -s a.png g.png || flunk "--exposure does not come before the scene's"
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

begin "view shows an EXR file as its scene's film would, and options come before that; layers have nothing of it"
small_scene
run render small.mns -o a.exr -o a.png
run render small.mns -o film.exr -o film.png --set film.exposure=-1 --set film.alpha=true --aov albedo
run view film.exr -o viewed.png
cmp -s film.png viewed.png || flunk "the film's exposure and alpha are not in the EXR file"
run view film.exr -o viewed.png --exposure 0 --alpha off
cmp -s a.png viewed.png || flunk "options do not come before the file's"
run view film.exr --layer albedo -o albedo.png
run render small.mns -o plain.exr --aov albedo
run view plain.exr --layer albedo -o plain-albedo.png
cmp -s albedo.png plain-albedo.png || flunk "the film's exposure darkens a layer that is no light"
run render small.mns -o automatic.exr -o automatic.png --set film.auto_exposure=true
run view automatic.exr -o viewed.png
says err "remark: the automatic exposure is the same as: --exposure "
cmp -s automatic.png viewed.png || flunk "the film's automatic exposure is not in the EXR file"
"$program" view - -o viewed.png < film.exr 2> err
cmp -s a.png viewed.png || flunk "a picture by standard input is shown with more than options say"
end

begin "view: a part of a picture, as bright as it is in the whole"
small_scene
run render small.mns -o a.exr -s 4
run view a.exr -o whole.png --auto-exposure on
run view a.exr -o part.png --auto-exposure on --crop 2,4,10,9
exits 0
says err "the automatic exposure is the same as: --exposure"
run view a.exr -o percent.png --auto-exposure on --crop 12.5%,25%,62.5%,56.25% -q
cmp -s part.png percent.png || flunk "percent are not the same pixels"
PYTHONPATH=$root/tests/cli "$python" -B - <<'PYTHON' || flunk "not the part of the picture"
from pixels import pixels
whole, part = pixels("whole.png"), pixels("part.png")
assert len(part) == 5 and len(part[0]) == 8
for y, row in enumerate(part):
    for x, pixel in enumerate(row):  # a last bit is dithered
        assert all(abs(a - b) <= 1 for a, b in zip(pixel, whole[4 + y][2 + x]))
PYTHON
run view a.exr -o part.png --crop 2,4,10,17
exits 2
says err "10,17 is outside of the picture of 16 x 16"
run view a.exr -o part.png --crop 4,4,4,9
says err "4,4,4,9 holds no pixel"
end

begin "view: another layer, by the AOV's name or the channel's"
small_scene
run render small.mns -o a.exr --aov depth,normal,medium,nesting,cryptomatte
run view a.exr --layer depth -o depth.png
exits 0
matches err '^meniscus view: remark: depth: black is [0-9.]*, white [0-9.]* and more; dark blue is where nothing is$'
sed 's/^camera {.*/camera { from = <0, 30, -1>  to = <0, 0, 0>  fov = 30 }/' small.mns > down.mns
run render down.mns -o down.exr --aov depth
run view down.exr --layer depth -o down.png
matches err '^meniscus view: remark: depth: black is [0-9.]*, white [0-9.]*$'
run view a.exr --layer Z -o z.png -q
empty err
cmp -s depth.png z.png || flunk "an AOV is not the layer of its channels"
run view a.exr --layer normal -o n.png --exposure 3
exits 0
empty err
run view a.exr --layer N -o n0.png
cmp -s n.png n0.png || flunk "directions get brighter by --exposure"
run view a.exr --layer medium -o m.png
run view a.exr --layer medium -o m1.png --exposure -2
empty err
if cmp -s m.png m1.png; then flunk "colours do not get darker by --exposure"; fi
run view a.exr --layer nesting -o x.png
exits 4
says err "the channels of 'nesting' are no colours; name one of them: nesting.depth, nesting.faults, nesting.silent"
run view a.exr --layer nesting.faults -o x.png
says err 'nesting.faults: all of it is 0'
run view a.exr --layer cryptomatte -o y.png
exits 2
run view a.exr --layer dpeth -o y.png
exits 4
says err "the picture has no layer 'dpeth'; did you mean 'depth'?"
run view a.exr --layer beauty -o y.png
matches err "the picture has no layer 'beauty', only: A, B, .*normal.*depth"
matches err "only: .*CryptoMaterial00, CryptoMaterial01, .*CryptoObject00, CryptoObject01, CryptoObject02"
says_not err cryptomatte
run view a.exr --layer CryptoObject00 -o y.png
exits 0
rm y.png
gone y.png
run view a.exr --aov depth -o y.png
exits 2
says err "unknown option '--aov'; here it is --layer depth"
end

begin "bench: paths and rays of one thread and of two"
run bench -j 2
exits 0
matches out '^ +1 thread +[0-9.]+ million paths a second +[0-9.]+ million rays a second$'
matches out '^ +2 threads +[0-9.]+ million paths a second .* [0-9.]+ x$'
run bench -j 1 --json
exits 0
is_json out
matches out '"pathsPerSecond": [1-9]'
end

begin "info: texts that would fill a terminal are cut short there, and nowhere else"
small_scene
for i in $(seq 60); do echo "sphere drop_$i { center = <$i, 20, 0>  radius = .2  interior = water }"; done >> small.mns
run render small.mns -o a.exr --aov object
run info a.exr
matches out '"drop_60":.*}$'
on_terminal xterm info a.exr
matches out 'meniscus/objects .{200,260}\.\.\. \([0-9]* bytes; --json has all\)'
end

begin "info: a picture that is cut short is an error, as for view"
small_scene
run render small.mns -q -o a.exr
head -c 1500 a.exr > cut.exr
for options in '' --json; do
    run info cut.exr $options
    exits 4
    says err "'cut.exr'"
    says err 'damaged or cut short'
    [ -s out ] && flunk "it describes what is not there"
done
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
{ printf 'mtllib a b.mtl\nusemtl red wax\n'; cat tetrahedron.obj; } > waxen.obj
run info waxen.obj
exits 0
says_not out 'meniscus import'
printf 'newmtl red wax\r\n  Kd .8 .1 .1\nmap_Kd -bm 1 wax.png\nillum 2\nKd\nnewmtl other\nNi 1.5 2\nNi x\n' > 'a b.mtl'
run info waxen.obj
matches out "^material +'red wax', 4 triangles: base colour 0.8 0.1 0.1, picture wax.png\$"
matches out '^materials +2$'
matches out '^a scene that has them +meniscus import waxen.obj$'
run info waxen.obj --json
is_json out
says out '"material": "base colour 0.8 0.1 0.1, picture wax.png"'
mkdir deep && sed 's/^mtllib .*/mtllib ..\/a b.mtl/' waxen.obj > deep/waxen.obj
run info deep/waxen.obj
says_not out 'meniscus import' # another folder's
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

begin "floats have the fewest digits in JSON"
small_scene
echo 'medium wet { ior = 1.34 }' >> small.mns
run check small.mns --json
says out '"ior": 1.34,'
printf 'v 0.1 0 0\nv 1.1 0 0\nv 0 1 0\nv 0 0 -.3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n' > fine.obj
run info fine.obj --json
says out '"x to": 1.1,'
says out '"z from": -0.3,'
run info fine.obj
matches out '^x to +1\.1$'
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

begin "check --files: what a scene reads"
mkdir -p parts && printf 'meniscus 1.0 unit mm\nmedium glass { ior = 1.5  state = solid }\n' > parts/glass.mns
cp "$root"/examples/assets/ice1.ply parts/ice.ply
cat > whole.mns <<'SCENE'
meniscus 1.0 unit mm
use "parts/glass.mns" as glass
use "std/media.mns" as media
mesh { file = "parts/ice.ply"  interior = glass.glass }
environment { }
camera { from = <0, 0, 100>  to = <0, 0, 0> }
SCENE
run check whole.mns --files
exits 0
[ "$(cat out)" = "whole.mns
parts/glass.mns
parts/ice.ply" ] || flunk "$(cat out)"
run check whole.mns --json
"$python" -c '
import json
assert json.load(open("out"))["files"] == ["whole.mns", "parts/glass.mns", "parts/ice.ply"]
' || flunk "the files in JSON"
rm parts/ice.ply
run check whole.mns --files
exits 3
[ ! -s out ] || flunk "a list that is not whole"
end

begin "check: crystals that refract doubly, once each, and both waves of a ray"
cat > spar.mns << 'EOF'
meniscus 1.0 unit mm
use "std/media.mns" as media
box { interior = media.calcite  from = <-9, 0, -9>  to = <9, 10, 9>  rotate(z, 45) }
box { interior = media.calcite  from = <-9, 0, -9>  to = <9, 10, 9>  translate(<40, 0, 0>) }
environment { }
camera { from = <0, 40, 60>  to = <0, 5, 0>  fov = 40 }
EOF
run check spar.mns --ray '-30,30,0:1,-1,0' --ray-least 20%
exits 0
matches out '^  calcite  index 1.658 and 1.486 '
[ "$(grep -c 'index 1.658' out)" -eq 1 ] || flunk "a crystal is listed twice"
matches out 'from air to calcite: 4[0-9].*, extraordinary '
matches out 'from air to calcite: 4[0-9].*, ordinary '
run check spar.mns --json
is_json out
says out '"extraordinary_ior": 1.486'
[ "$(grep -c '"optic_axis"' out)" -eq 2 ] || flunk "the axes are not two"
end

begin "check --ray: where light goes, surface by surface, and drawn into a slice"
cat > lens.mns <<'SCENE'
meniscus 1.0 unit mm
medium crown { ior = cauchy(1.5046, .0042)  state = solid }
environment { }
intersection lens { interior = crown  sphere { center = <48, 0, 0>  radius = 50 }  sphere { center = <-48, 0, 0>  radius = 50 } }
box screen { surface = surface { albedo = .5 }  from = <49, -10, -10>  to = <50, 10, 10> }
camera { from = <-200, 5, 0>  to = <0, 5, 0>  fov = 10 }
film { size = <9, 9> }
SCENE
run check lens.mns --ray=-30,5,0:1,0,0
exits 0
says out "Light of 589.3 nm from -30, 5, 0, in air, along 1, 0, 0"
matches out '^  1 +28.3 mm +lens +from air to crown: 95.8 % +5.739° to 3.78° +100 %$'
matches out '^  3 +[0-9.]+ mm +screen +ends there +91.7 %$'
matches out '^  turned by 5.[0-9]+° in all; the optical path is 8[0-9.]+ mm$'
run check lens.mns --ray=-30,40,0:1,0,0
says out "  it meets nothing"
cat > slab.mns <<'SCENE'
meniscus 1.0 unit mm
medium crown { ior = 1.5  state = solid }
box slab { from = <-50, -20, -50>  to = <50, 0, 50>  interior = crown }
environment { }
camera { from = <0, 100, 100> }
SCENE
run check slab.mns --ray=-10,10,0:.3,-1,.1
matches out '^  turned by 0° in all; the optical path up to the last surface is '
run check lens.mns --ray 4,4 --size 9x9
says out "from -200, 5, 0, in air, along 1, 0, 0"
run check lens.mns --ray=-30,5,0:1,0,0 --ray-least 1% --json
"$python" -c '
import json, sys
ray, = json.load(open("out"))["rays"]
assert ray["start"] == "air" and ray["complete"], ray
ways = ray["ways"]
assert [s["turn"] for s in ways[0]["steps"]] == ["passes", "passes", "ends"], ways[0]
assert [(w["from_way"], w["from_step"]) for w in ways[1:]] == [(0, 0), (0, 1)], ways
assert ways[1]["steps"][0]["turn"] == "mirrored" and ways[1]["steps"][1]["length"] is None, ways[1]
assert sum(w["steps"][-1]["carried"] for w in ways) > .99, ways
' || flunk "the JSON of --ray"
run check lens.mns --slice z=0 --slice-output bare.png -q
run check lens.mns --slice z=0 --slice-output rays.png --slice-region=-40,-12,52,12 --ray=-30,-8,0..-30,8,0:1,0,0/9 --ray-wavelength 650,450
exits 0
says out "Where 18 rays of light end"
matches out '^  1  650 nm  pp  screen at 49, 0.[0-9]+, 0 +[0-9.]+°  9[0-9.]+ %$'
matches out '^  #[0-9a-f]{6}  light of 450 nm$'
[ "$(grep -c '^ .*pp  screen at' out)" = 18 ] || flunk "the ends of 18 rays"
"$python" - <<'PYTHON' || flunk "the rays are drawn"
import json, struct, subprocess, zlib
def pixels(name):
    data = open(name, "rb").read()
    at, idat = 8, b""
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR": width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
        if kind == b"IDAT": idat += data[at + 8:at + 8 + n]
        at += 12 + n
    assert depth == 8 and color == 2, (depth, color)
    raw, step, rows, before = zlib.decompress(idat), 3 * width + 1, [], bytes(3 * width)
    for y in range(height):
        filter, row = raw[y * step], bytearray(raw[y * step + 1:(y + 1) * step])
        for i in range(len(row)):
            a, b, c = (row[i - 3] if i >= 3 else 0), before[i], (before[i - 3] if i >= 3 else 0)
            if filter == 1: row[i] = row[i] + a & 255
            if filter == 2: row[i] = row[i] + b & 255
            if filter == 3: row[i] = row[i] + (a + b) // 2 & 255
            if filter == 4:
                p = a + b - c
                row[i] = row[i] + min((a, b, c), key=lambda v: abs(p - v)) & 255
        rows.append(bytes(row)); before = bytes(row)
    return width, rows
width, rows = pixels("rays.png")
# 9 lines cross a column in front of the lens, where all is white; both colours lie over each other there
column = [rows[y][3 * 150:3 * 150 + 3] for y in range(300)]
lines = sum(1 for a, b in zip(column, column[1:]) if min(a) > 240 and min(b) <= 240)
assert lines == 9, lines
PYTHON
for wrong in 1 1,2,3 1,2,3: 1,2,3:0,0,0 1,2,3:1,0,0/3 1,2,3:1,0,0/x 1,2,3..1,2:1,0,0 1,2,3:1,0,0.. 1.5,2 99,99; do
    run check lens.mns --ray "$wrong"
    exits 2
    says err "option '--ray'"
done
run check lens.mns --ray=-30,0,0:1,0,0 --ray-wavelength 200
exits 2
says err "from 360 to 830"
run check lens.mns --ray-least 1%
exits 2
says err "option '--ray-least' means nothing without '--ray'"
run check lens.mns --ray 49,0,0:1,0,0
exits 2
says err "this is one of 'screen'"
sed -e '/^camera/d' -e '/^environment/d' lens.mns > bench.mns
for bare in "--ray=-30,5,0:1,0,0" "--ray=-30,5,0:1,0,0 --slice z=0 --slice-output bench.png" "--slice z=0 --slice-output bench.png"; do
    run check bench.mns $bare # no picture is made of it
    exits 0
    says_not err 'no-'
done
for picture in "" "--ray 4,4" "--slice z=0 --slice-output bench.png --pixel 4,4"; do
    run check bench.mns $picture
    exits 3
    says err '[no-camera]'
done
{ echo 'animation { frames = 3 }'; cat bench.mns; } | sed 's/^meniscus.*//' > rest.mns
{ echo 'meniscus 1.0 unit mm'; cat rest.mns; } > bench.mns
run check bench.mns --ray=-30,5,0:1,0,0
exits 0
end

begin "check --pixel: what stands along a line of sight, and why"
cat > sight.mns <<'SCENE'
meniscus 1.0 unit mm
medium glass { ior = 1.5  state = solid }
medium water { ior = 1.33  state = liquid }
medium ghost { ior = 1  state = gas }
box pane { interior = glass  from = <-9, -9, 0>  to = <9, 9, 4> }
box pond { interior = water  from = <-8, -8, -20>  to = <8, 8, 1> }
difference { interior = ghost  sphere { center = <0, 0, -10>  radius = 3 }  sphere { center = <0, 0, -10>  radius = 1 } }
box wall { surface = surface { }  from = <-9, -9, -40>  to = <9, 9, -30> }
camera { from = <0, 0, 100>  to = <0, 0, 0>  fov = 10deg }
environment { }
film { size = <9, 9> }
SCENE
run check sight.mns --pixel 4,4 -q
run check sight.mns --pixel 4,4
exits 0
says out "Along the line, which starts in air"
matches out '^ +96.0 mm +pane +boundary from air to glass$'
matches out '^ +99.0 mm +pond +entered in silence: pane is on top, by state of matter$'
matches out '^ +100 mm +pane +boundary from glass to water$'
matches out '^ +107 mm +difference 1 +boundary from water to ghost$'
matches out '^ +109 mm +difference 1 +boundary from ghost to water$'
matches out '^ +120 mm +pond +boundary from water to air$'
matches out '^ +130 mm +wall +opaque$'
run check sight.mns --pixel 4,4 --json
"$python" -c '
import json, sys
s = json.load(open("out"))["sight"]
assert s["start"] == "air", s
assert [x["kind"] for x in s["surfaces"]] == ["boundary", "silent", "boundary", "boundary", "boundary", "boundary", "boundary", "boundary", "opaque"], s
' || flunk "the JSON of --pixel"
cat > cut.mns <<'SCENE'
meniscus 1.0 unit mm
medium glass { ior = 1.5  state = solid }
medium water { ior = 1.33  state = liquid }
box pane { interior = glass  from = <-9, -9, 0>  to = <9, 9, 40> }
difference pond { interior = water  box { from = <-8, -8, -20>  to = <8, 8, 30> }  sphere { center = <0, 0, 15>  radius = 5 } }
union twins { interior = water  box { from = <-2, -2, -40>  to = <2, 2, -30> }  box { from = <-2, -2, -50>  to = <2, 2, -35> } }
intersection elsewhere { interior = water  box { from = <-2, -2, -70>  to = <2, 2, -60> }  sphere { center = <30, 0, -65>  radius = 2 } }
camera { from = <0, 0, 100>  to = <0, 0, 0>  fov = 10deg }
environment { }
film { size = <9, 9> }
SCENE
run check cut.mns --pixel 4,4 # the cut is in the pane; what ends within a combination, or outside of it, is no surface
matches out '^ +80.0 mm +pond +left in silence: pane is on top, by state of matter$'
matches out '^ +90.0 mm +pond +entered in silence: pane is on top, by state of matter$'
[ "$(grep -c '^ .* twins  *boundary' out)" = 2 ] || flunk "boundaries between the twins"
[ "$(sed -n '/^Along/,$p' out | grep -c elsewhere)" = 0 ] || flunk "a surface of what the line passes by"
run check sight.mns --pixel 9,0
exits 2
says err "no pixel of the picture, 0,0 to 8,8"
run check sight.mns --pixel 9,0 --size 18x12
exits 0
says out "Along the line, which starts in air"
run check sight.mns --pixel 18,0 --scale 2
exits 2
says err "no pixel of the picture, 0,0 to 17,17"
{ cat sight.mns; echo 'camera below { from = <0, 0, -25>  to = <0, 0, -90>  fov = 10deg }'; } > two.mns
run check two.mns --pixel 4,4 --camera below
exits 0
matches out '^ +5.00 mm +wall +opaque$'
run check two.mns --pixel 4,4 --camera belwo
exits 3
says err "did you mean 'below'?"
sed 's/^camera .*/camera { projection = fisheye  from = <0, 0, 100>  to = <0, 0, 0> }/' sight.mns > round.mns
run check round.mns --pixel 0,0
exits 2
says err "camera 1 sees nothing at 0,0"
sed 's/^camera .*/camera { projection = orthographic  width = 27  from = <0, 0, -5>  to = <0, 0, -9>  expect = [water] }/' sight.mns > flat.mns
run check flat.mns --pixel 4,4
exits 0
says out "Along the line, which starts in water"
run check flat.mns --pixel 0,4
says out "Along the line, which starts in air"
end
