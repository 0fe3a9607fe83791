# scenes.sh - scenes that cannot be read or have mistakes, and standard input.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "files that are not there: the one that may be meant"
small_scene
mkdir pictures
: > pictures/wood.png
: > colors.mns
run check smal.mns
exits 4
says err "cannot read 'smal.mns': No such file or directory; did you mean 'small.mns'?"
run check "$scratch/work/Small.mns"
says err "did you mean '$scratch/work/small.mns'?"
: > glass.0002.exr
: > glass.0001.exr
: > glass.0001.exr.1-1.tmp
run info glass.exr
says err "did you mean 'glass.0001.exr'?"
run info 'glass.####.exr'
says err "did you mean 'glass.0001.exr'?"
run view pictures/wod.png -o a.png
says err "did you mean 'pictures/wood.png'?"
{ cat small.mns; echo 'sphere { surface = surface { albedo = image { file = "pictures/wodo.png" } } }'; } > textured.mns
run check textured.mns
exits 3
says err "hint: did you mean 'pictures/wood.png'?"
{ cat small.mns; echo 'use "colros.mns" as c'; } > using.mns
run check using.mns
says err "hint: did you mean 'colors.mns'?"
run info nothing-like-it.exr
says_not err "did you mean"
run info nowhere/glass.exr
says_not err "did you mean"
end

begin "a missing scene: status 4"
run render missing.mns
exits 4
says err "cannot read 'missing.mns': No such file or directory"
small_scene
run render small -o a.exr
exits 4
says err "cannot read 'small': there is no such file, but 'small.mns'"
end

begin "a picture, and a text in UTF-16, in place of a scene: one message"
small_scene
run render small.mns -o a.exr
run check a.exr
exits 3
says err "a.exr:1:1: error: the file is no text in UTF-8"
says err "a.exr: 1 error"
printf '\377\376m\000e\000' > wide.mns
run check wide.mns
exits 3
says err "it is in UTF-16: save it as UTF-8"
says err "wide.mns: 1 error"
run fmt --check wide.mns
exits 3
end

begin "names that options give and the scene has not: what there is"
small_scene
echo 'preset draft { render { samples = 1 } }' >> small.mns
run check small.mns -D x=1
exits 3
says err "its parameters: level"
run check small.mns --preset x
exits 3
says err "its presets: draft"
run render small.mns --camera x -o a.exr
exits 3
says err "its cameras: camera 1"
end

begin "a folder as a scene: status 4"
mkdir folder.mns
run render folder.mns
exits 4
says err "'folder.mns'"
end

begin "folders of options that are not there: status 4"
small_scene
run check small.mns -I .
exits 0
run check small.mns -I . -I nowhere
exits 4
says err "option '--include': there is no folder 'nowhere'"
run check small.mns --confine small.mns
exits 4
says err "option '--confine': there is no folder 'small.mns'"
end

begin "files that a scene names are regular files: no pipe is waited for, and no device read"
mkfifo pipe
mkdir folder
small_scene
cp small.mns piped.mns
for file in pipe /dev/zero folder; do
    sed "\$a mesh { file = \"$file\"  interior = glass }" small.mns > piped.mns
    run check piped.mns
    exits 3
    says err "'$file' is "
    sed "1a include \"$file\"" small.mns > piped.mns
    run check piped.mns
    exits 3
    says err '[file-unreadable]'
done
cat small.mns > pipe &
run check pipe
exits 0
wait
end

begin "syntax errors: place, line, caret, code, count; status 3"
printf 'meniscus 1.0 unit mm\nsphere { radius = }\nmedium glass { iorr = 1.5 }\n' > bad.mns
run render bad.mns
exits 3
matches err '^bad\.mns:2:[0-9]+: error: .*\[[a-z-]+\]$'
matches err '^ +2 \| sphere \{ radius = \}$'
matches err '^ +\| +\^'
matches err '^bad\.mns: [0-9]+ errors?'
gone bad.exr
end

begin "a wrong property: did you mean"
small_scene
sed -i 's/fov = 30/fow = 30/' small.mns
run check small.mns
exits 3
says err "[unknown-property]"
says err "did you mean 'fov'?"
end

begin "mistakes as JSON, each line an object"
small_scene
sed -i 's/fov = 30/fow = 30/' small.mns
run render small.mns --log-format json
exits 3
while read -r line; do printf '%s\n' "$line" > line; is_json line; done < err
says err '"code": "unknown-property"'
run check small.mns --json
exits 3
is_json out
says out '"report": null'
end

begin "an unknown camera, parameter or preset: status 3"
small_scene
run render small.mns --camera sid
exits 3
says err "did you mean 'side'?"
run render small.mns -D levle=3
exits 3
run render small.mns --preset draft
exits 3
run render small.mns -D level=9
exits 3
end

begin "parameters, cameras and defines"
small_scene
run params small.mns
exits 0
matches out '^level = 3 +radius of the water, in 1..5$'
run params small.mns --json
is_json out
says out '"type": "a number"'
says out '"range": "1..5"'
run params small.mns -D level=4 -D level=2
matches out '^level = 2'
cat >units.mns <<'EOF'
meniscus 1.0 unit mm
param level = 3cm in 5mm..60mm "height"
param turn = .25turn   param place = <1cm, 2, .5>   param light = 2700K   param blink = 20ms   param n = 1e6
print(level, turn, place, light, blink, n)
EOF
run params units.mns -q
exits 0
matches out '^level = 30mm +height, in 5mm..60mm$'
matches out '^turn  = 90deg$'
matches out '^place = <10mm, 2mm, 0.5mm>$'
matches out '^light = 2700K$'
matches out '^blink = 0.02s$'
matches out '^n     = 1000000$'
run params units.mns -q --json
is_json out
says out '"unit": "mm"'
run render small.mns --camera side -o side.exr -D level=2
exits 0
run info side.exr
matches out 'meniscus/camera +side'
end

begin "a scene on standard input"
small_scene
"$program" render - -o a.exr < small.mns > out 2> err
status=$?
exits 0
there a.exr
"$program" - < small.mns > out 2> err
status=$?
exits 0
there scene.exr
end

begin "mistakes on standard input quote their line"
printf 'meniscus 1.0 unit mm\nsphere { radius = }\n' | "$program" render - > out 2> err
status=$?
exits 3
matches err '^<stdin>:2:'
says err "sphere { radius = }"
end

begin "a scene on standard input is confined to the current folder"
small_scene
sed -e 's/environment { color = 1 }/environment { image = "..\/outside.exr" }/' small.mns > inner.mns
mkdir inner
run render small.mns -o outside.exr
(cd inner && "$program" render - -o a.exr < ../inner.mns > ../out 2> ../err)
status=$?
exits 3
says err "[outside-confine]"
end

begin "check: the report, and warnings as errors"
small_scene
run check small.mns
exits 0
says out glass
says out water
run check small.mns --json
exits 0
is_json out
sed -i 's/^film/let unused = 1\nfilm/' small.mns
run check small.mns
exits 0
says err "[unused-name]"
run check small.mns --werror
exits 3
run check small.mns -q
exits 0
empty out
cat >gone.mns <<'EOF'
meniscus 1.0
medium glass { ior = 1.5 }
difference gone { sphere { radius = 1 }  sphere { radius = 2 }  interior = glass }
sphere there { center = <9, 0, 0>  radius = 1  interior = glass }
environment { }   camera { from = <0, 0, 9>  to = <0, 0, 0> }
EOF
run check gone.mns
exits 0
says err "nothing is left of gone"
matches out '^  gone +glass +empty '
matches out '^  there +glass +4.19 '
end

begin "check: slices"
small_scene
run check small.mns --slice x=0
exits 0
there small-slice.png
says out "The slice small-slice.png, 800 x 800 pixels, 8.8 x 8.8 units"
matches out '^  #[0-9a-f]+  water: sphere$'
run check small.mns --slice 0,5,0:1,1,1 --slice-output a.png --slice-region -2,-1,2,1 --slice-size 200x50 --json
exits 0
is_json out
says out '"file": "a.png"'
run info a.png
matches out '^width +200$'
run check small.mns --slice x=0 --slice-output b.png -j 1 -q
empty out
cmp -s small-slice.png b.png || flunk "the slice depends on the number of threads"
cat > tall.mns <<'EOF'
meniscus 1.0 unit cm
medium glass { ior = 1.5  state = solid }
medium water { ior = 1.33  state = liquid }
cylinder { to = <0, 30, 0>  radius = 1  interior = glass }
cylinder { from = <0, 3, 0>  to = <0, 40, 0>  radius = .5  interior = water }
camera { from = <0, 10, 50> }
environment { }
EOF
run check tall.mns --slice z=0 # the legend's last line takes two rows
says out "The slice tall-slice.png, 320 x 800 pixels"
run info tall-slice.png
matches out '^height +938$'
run check tall.mns --slice z=0 --slice-size 200x800 # the bar stands below it
run info tall-slice.png
matches out '^height +1094$'
run check tall.mns --slice z=0 --slice-size 60x200 # nothing but a letter fits into a row
run info tall-slice.png
matches out '^height +338$'
for wrong in x q=1 x=1cm 1,2,3 0,0,0:0,0,0; do
    run check small.mns --slice $wrong
    exits 2
    says err "option '--slice'"
done
run check small.mns --slice x=0 --slice-region 1,1,0,0
exits 2
run check small.mns --slice-size 100x100
exits 2
says err "means nothing without '--slice'"
run check small.mns --slice x=0 --slice-output a.exr
exits 2
run check small.mns --slice x=0 --slice-output missing/a.png
exits 5
run check small.mns --slice x=0 --nesting entered
exits 2
says err "under the policy entered"
no_leftovers
end

begin "check: remarks, which are no warnings"
small_scene
sed -i 's/^film/sphere speck { radius = 4um  center = <0, 20, 0>  interior = glass }\nfilm/' small.mns
run check small.mns --werror
exits 0
matches err '^small\.mns:11:1: remark: speck is .* smaller than anything else in the scene \[odd-size\]$'
says err "small.mns: 1 remark"
run check small.mns --json
is_json out
says out '"severity": "remark"'
says out '"remarks": 1'
run check small.mns -q
exits 0
empty err
run render small.mns -s 1
says_not err remark
run help odd-size
says out "odd-size (remark)"
end

begin "a height field from a picture: its values as they are in the file"
small_scene
run render small.mns -o heights.png
exits 0
cat > field.mns <<'SCENE'
meniscus 1.0 unit cm
medium ice { ior = 1.31 }
height_field pond { interior = ice  image = "heights.png"  size = <2, 1, 2> }
environment { }
camera { from = <0, 5, 9> }
SCENE
run check field.mns
exits 0
says_not err 'error'
says_not err 'warning'
sed -i 's/size = <2/base = 2  size = <2/' field.mns
run check field.mns
exits 3
matches err 'the lowest height, .* in row .*, column .*, is not above the base, 2: write base = [-.0-9]*, or less'
end

begin "an isosurface renders, and dump says that it cannot write it"
cat > egg.mns <<'SCENE'
meniscus 1.0 unit cm
medium ice { ior = 1.31 }
def egg(x, y, z) = x ^ 2 + y ^ 2 * (1 + .2 * y) + z ^ 2 - .5
isosurface { interior = ice  function = egg }
environment { }
camera { from = <0, 0, 9> }
film { size = <8, 8> }
render { samples = 1 }
SCENE
run render egg.mns -o egg.exr
exits 0
there egg.exr
same_flat egg.mns
end

begin "scenes: a function of an environment shines with its colour, of whatever spectrum"
sky_scene() { # WHAT
    cat << SCENE
meniscus 1.0 unit cm
def _everywhere(p) = 2
def _above(p) = p.y > 0 ? 1 : .5
let narrow = spectrum([<540, 0>, <550, 1>, <560, 0>])
environment { $1 }
sphere { radius = 3  surface = surface { albedo = .8 } }
camera { from = <0, 5, 20>  to = <0, 0, 0>  fov = 30 }
film { size = <24, 24> }
render { samples = 64  fireflies = keep }
SCENE
}
sky_scene "color = narrow  strength = 2" > even.mns
sky_scene "color = narrow  function = _everywhere  resolution = 64" > asked.mns
sky_scene "color = narrow  function = _above" > above.mns
sky_scene "color = narrow  sky = clear" > sky.mns
run render even.mns -o even.exr
exits 0
run render asked.mns -o asked.exr
exits 0
run compare even.exr asked.exr --max-rmse 0.03
exits 0
run render above.mns -o above.exr
exits 0
run check sky.mns
exits 3
says err "'color' and 'sky' exclude each other"
end

begin "scenes: the fog that is recommended is one"
for wrong in 'environment { fog = .1 }' 'fog { density = .1 }'; do
    printf 'meniscus 1.0 unit cm\n%s\n' "$wrong" > fog.mns
    run check fog.mns
    exits 3
    {
        echo 'meniscus 1.0 unit cm'
        sed -n 's/.*hint: write: \(box .*\), around what is seen, with: \(medium .*\)/\2 \1/p' err
        echo 'sphere { surface = surface { } } camera { from = <0, 0, 5>  to = <0, 0, 0> } environment { }'
    } > right.mns
    run check right.mns --werror
    exits 0
    matches out 'box .* fog'
done
end

begin "what is outside of the folder of --confine is outside, whether it is there or not"
mkdir -p inner/deep outer
echo 'meniscus 1.0' > outer/there.mns
cp outer/there.mns inner/own.mns
cp outer/there.mns inner/deep/own.mns
ln -s ../outer inner/link
ln -s . inner/self
tried() { # NAME REPORT: what comes of a file of that name, here and in a folder of -I
    printf 'meniscus 1.0 unit cm\ninclude "%s"\nsphere { surface = surface { } }\n' "$1" > inner/scene.mns
    printf 'environment { }\ncamera { from = <0, 0, 5>  to = <0, 0, 0> }\n' >> inner/scene.mns
    run check inner/scene.mns --confine inner
    if [ -z "$2" ]; then exits 0; else exits 3; says err "[$2]"; fi
    run check "$PWD/inner/scene.mns" --confine "$PWD/inner/self"
    if [ -z "$2" ]; then exits 0; else exits 3; says err "[$2]"; fi
    "$program" check - --confine inner -I inner -I outer < inner/scene.mns > out 2> err
    status=$?
}
for there in there nothing; do
    tried "../outer/$there.mns" outside-confine
    tried "$PWD/outer/$there.mns" outside-confine
    tried "/$there/$there.mns" outside-confine
    tried "/etc/passwd/../$there" outside-confine
    tried "link/$there.mns" outside-confine
    tried "link/$there/$there.mns" outside-confine
    tried "../outer/$there/../../inner/own.mns" ''
    tried "../outer/$there.mns/../../../inner/nothing.mns" outside-confine
done
tried own.mns ''
exits 0
tried ./deep/../deep//own.mns ''
tried "$PWD/inner/deep/own.mns" ''
tried self/deep/own.mns ''
tried nothing.mns file-not-found
tried deep/nothing.mns file-not-found
tried deep file-unreadable
# a folder that is searched, but outside
tried there.mns file-not-found
run check inner/scene.mns --confine inner -I outer
exits 3
says err "hint: the folder 'outer' is not searched: it is outside of 'inner', to which the scene is confined"
end

begin "a ball of glass in the light of a point: the part of the picture behind it is named, where the camera sees that"
cat > ball.mns << 'SCENE'
meniscus 1.0 unit cm
light { shape = point  from = <40, 80, -40>  power = 60 }
plane { surface = surface {} }
sphere { interior = medium { ior = 1.5 }  center = <0, 10, 0>  radius = 10 }
camera at { from = <0, 30, -80>  to = <0, 8, 0>  fov = 40deg }
camera off { from = <0, 30, 80>  to = <0, 8, 200>  fov = 40deg }
film { size = <32, 24> }
render { samples = 1 }
SCENE
run check ball.mns
exits 0
says err "5 % of the picture is in the dark behind that"
says err "write, say, shape = sphere  radius = 1"
run render ball.mns -o a.exr
exits 0
says err "5 % of the picture is in the dark behind that"
run check ball.mns --camera off
exits 0
says_not err "lost-light"
sed 's/shape = point/shape = sphere  radius = 1/' ball.mns > lamp.mns
run check lamp.mns
says_not err "lost-light"
end

begin "a pane too thin for where it is: render says so, too, unless it is to be quiet"
cat > pane.mns << 'SCENE'
meniscus 1.0 unit cm
box { from = <-5, -1e-5, -5>  to = <5, 0, 5>  interior = medium { ior = 1.5 }  translate(<1000, 1000, 1000>) }
ground { y = 980  surface = surface { } }
camera { from = <1000, 1010, 1000>  to = <1000, 1000, 1000>  up = z }
environment { }
film { size = <8, 8> }
render { samples = 1 }
SCENE
run render pane.mns -o a.exr
exits 0
says err "box 1 is 100 nm thick where coordinates tell surfaces apart only down to 4.79 µm [coarse-place]"
run render -q pane.mns -o a.exr
exits 0
says_not err "coarse-place"
end

begin "what stands in the examples stands on air, not glued to the table"
cp "$root"/examples/*.mns .
ln -s "$root/examples/assets" assets
for scene in beams cut-glass minirt soda tea whisky whisky-sun; do
    run check $scene.mns
    exits 0
    says_not err remark
    says_not err warning
done
end
