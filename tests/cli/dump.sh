# dump.sh - dump --flat: a scene with everything expanded is a scene of the same meaning.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "dump --flat: every example keeps its hash"
all_scenes
for scene in *.mns; do
    case $scene in lang_* | studio.mns) continue ;; esac # parts, and scenes whose files are not there
    case $scene in
        soda.mns) same_flat "$scene" --set camera.shutter=0 ;; # a dump is of one moment
        *) same_flat "$scene" ;;
    esac
done
end

begin "dump --flat: shared nodes, prototypes, instances, shadowed names, transforms, none"
cat > shared.mns <<'SCENE'
meniscus 1.0 unit cm
medium glass { ior = cauchy(1.5, .004)  state = solid }
medium air { ior = 1.0003 state = gas }
def mk(r) = sphere { radius = r interior = glass }
let s = surface { albedo = #abc }
let ball = sphere { radius = 2 surface = s  translate(<0,3,0>) }
ball { translate(x * 5) }
ball { rotate(z, 90)  surface = none interior = air}
let both = group { ball {} ball { scale(2) } translate(y * .1) }
both { rotate(y, 33) }
both { rotate(y, 66) box { size = <1,2,3> surface = s } }
let g2 = ball { radius = 3 }
g2 { translate(z) } g2 { interior = glass surface = none }
for (i in 1..3) { sphere bead { radius = i  surface = s translate(<i * 10, .1, 0>) } }
box named { size = <1, 1, 1> surface = s translate(z * 30) }
named { translate(y * 9) }
world { medium = air }
let m = mesh { positions = [<0,0,0>,<1,0,0>,<0,1,0>,<0,0,1>] triangles = [<0,2,1>,<0,1,3>,<1,2,3>,<0,3,2>] interior = glass }
for (i in 0..<5) { m { translate(<i * 1.1, -20.3, 0>) rotate(<1, 2, 3>) } }
camera { from = <0, 3, -30>  to = <0, 0, 0> expect = [air] }
camera side { from = <30, 3, -30>  to = <0, 0, 0> }
light { shape = sphere radius = 2 from = <0, 50, 0> power = 3 }
render { samples = 4 nesting = none }
SCENE
same_flat shared.mns
run dump shared.mns
says out 'let s = surface { '
says out 'sphere bead__3 { '
says out 'ball { interior = air  surface = none  matrix('
says_not out 'for ('
end

begin "dump --flat: what is declared long before it is used, and what others are made from"
cat > early.mns <<'SCENE'
meniscus 1.0 unit mm
medium glass { ior = 1.5 }
medium base { ior = 1.5 }
let lbase = medium { ior = 1.6 }
let red = base { depth = 3 tint = rgb(1,.1,.1) }
let blue = lbase { depth = 3 tint = rgb(.1,.1,1) }
surface tiles { albedo = .3 }
surface rough { ior = 1.5 roughness = .3 }
let rougher = rough { albedo = .2 }
checker squares { translate(x) }
def dens(p) = p.x
volume cloud { function = dens  from = <0, 0, 0>  to = <2, 2, 2> translate(3*x) }
surface lone { albedo = squares }
medium fog { ior = 1 density = cloud absorption = .1 }
camera { from = <0,0,-50> to = <0,0,0> }
environment { color = 1 }
sphere { radius = 1 interior = glass }
sphere { radius = 1 surface = rougher  translate(4*x) }
sphere { radius = 1 surface = tiles translate(8*x) }
sphere { radius = 1 surface = tiles translate(12*x) }
sphere { radius = 1 surface = surface { albedo = squares } translate(16*x) }
sphere { radius = 1 surface = surface { albedo = squares } translate(20*x) }
sphere { radius = 1 interior = red translate(24*x) }
sphere { radius = 1 interior = red translate(28*x) }
sphere { radius = 1 interior = blue translate(32*x) }
sphere { radius = 1 interior = fog translate(36*x) }
SCENE
same_flat early.mns
run dump early.mns
says out 'medium base { '
says_not out 'lbase'
says out 'surface lone { '
run check -q flat.mns
says err "'base' is never used" # what was made of it stands by itself
says err "'lone' is never used"
[ "$(grep -c unused-name err)" = 2 ] || flunk "what the dump adds is not used"
end

begin "dump --flat: what varies from object to object of a loop's name does so in the dump"
cat > boards.mns <<'SCENE'
meniscus 1.0 unit cm
let wood = surface { albedo = variation { } }
for (i in 1..4) { box board { size = <1, 1, 1>  surface = wood  translate(x * 2 * i) } }
for (i in 1..2) { sphere { surface = wood  translate(y * 3 * i) } }
box board_of_oak { size = <1, 1, 1>  surface = wood  translate(z * 5) }
camera { from = <0, 3, -30>  to = <0, 0, 0> }
environment { }
SCENE
same_flat boards.mns
run dump boards.mns
says out 'box board__4 { '
end

begin "dump --flat: what is placed is called as in the scene, also what prototypes of one name, or one under several names, are made of"
cat > names.mns <<'SCENE'
meniscus 1.0 unit cm
let wood = surface { albedo = variation { } }
box board { size = <1, 1, 1>  surface = wood  translate(<-9, -4, 0>) }
board { translate(<2, 0, 0>) }
let plain = [box { size = <1, 1, 1>  surface = wood }]
for (i in 0..2) {
  let board = box { size = <1, 1.5, 1>  surface = wood  translate(<2 * i, 0, 0>) }
  board { translate(<0, -4, 0>) }
  let plank = board { translate(<0, 4, 0>) }
  plank { }
  let nameless = plain[0]
  nameless { translate(<2 * i, 2, 0>) }
  let crate = surface { albedo = noise { vary = 3 } }
  sphere { surface = crate  translate(<-4 - 2 * i, 0, 0>) }
  sphere { surface = crate  translate(<-4 - 2 * i, 2, 0>) }
}
let stack = group { for (i in 0..1) { box board { size = <1, 1, 1>  surface = wood  translate(<2 * i, 6, 0>) } } }
stack { }
stack { translate(<-6, 0, 0>) }
camera { from = <0, 0, 30>  to = <0, 0, 0> }
environment { }
film { size = <32, 24>  aovs = ["object", "cryptomatte"] }
SCENE
same_flat names.mns
says out 'let board__'
says out 'let plank = board'
run render names.mns -s 2 -q -o names.exr
mv flat.mns names.mns
run render names.mns -s 2 -q -o flat.exr
cmp -s names.exr flat.exr || flunk "the pictures differ, or the names in them"
end

begin "dump --flat: functions become defs, with the values that they saw"
cat > functions.mns <<'SCENE'
meniscus 1.0 unit cm
use "helpers.mns" as helpers
medium ice { ior = 1.31 }
let bumps = [<1, 2>, <-.5, 3>]   var drift = .25   let deep = -2   let name = "b"
def length(p) = sqrt(dot(p, p))
def twice(x: number, times = 2 * 1) = x * times
def fall(n) = n <= 0 ? 0 : n + fall(n - 1)
def lumpy(p) = let (r = length(p), s = sum([for (b in bumps) b.x * sin(b.y * 30deg) ^ 2]))
  r - .7 + .02 * s - deep ^ 2 * .01 + (r > .5 and not (p.x > 0 or p.y < -9) ? twice(.01) - (.1 - .2) : -drift ^ 2 * fall(3) / 100) +
  .001 * (bumps[1].y % 2) + .001 * len([for (i in 0..<3) if (i != 1) i]) + (name == "b" ? 0 : 1) + helpers.lean(p)
isosurface { interior = ice  function = lumpy  tolerance = .1 }
drift := .3
isosurface { interior = ice  function = lumpy  tolerance = .1  translate(x * 5) }
def ball(r) {
  let half = r / 2
  def at(x, y, z) = let (p = <x, y, z>) max(length(p) - half - (let (q = half) q), -z)
  isosurface { interior = ice  function = at  from = <-r, -r, -r> * 1.2  to = <r, r, r> * 1.2  tolerance = .1  translate(y * 9 * r) }
}
ball(.5) ball(.8)
medium fog { mixes = true  scattering = 1  density = volume { function = helpers.lean2  cells = 8 } }
sphere { interior = fog  radius = 1  translate(z * 8) }
camera { from = <0, 0, 19> }
SCENE
cat > helpers.mns <<'SCENE'
meniscus 1.0
let tilt = .125
def length(p) = p.x * tilt
def lean(p) = .01 * length(p)
def lean2(p) = max(0, .5 + lean(p))
SCENE
same_flat functions.mns
run dump functions.mns
says out 'def length__2(p) = sqrt(dot(p, p))'
says out 'def lumpy__2(p) = '
says out 'def at__2(x, y, z) = let (p = <x, y, z>) max(length__2(p) - 0.4 - (let (q = 0.4) q), -z)'
[ "$(grep -c '^def length' out)" -eq 2 ] || flunk "a function that is the same is written twice"
says_not out 'bumps'
# what is no number, vector or text
for use in 'let part = sphere { }  def f(p) = inside(part, p) ? -1 : 1' 'let h = hit(sphere { }, <0, 0, -9>, z)  def f(p) = p.x + h.distance'; do
    printf '%s\n' 'meniscus 1.0 unit cm' 'medium ice { ior = 1.31 }' "$use" 'isosurface { interior = ice  function = f }' > node.mns
    run dump node.mns
    exits 3
    says err "'f' uses "
    says err '[not-flat]'
done
end

begin "dump --flat: long lines within nodes that stand within others are laid out as fmt does"
{
    echo 'meniscus 1.0 unit mm'
    echo 'let rough = surface { albedo = rgb(.123456789, .23456789, .3456789) ior = 1.5  roughness = .123456789  emission = rgb(.123456789, .2, .3) }'
    echo 'sphere a_name_that_takes_up_room { center = <1.23456789, 2.3456789, 3.456789>  radius = 1.23456789'
    echo '  surface = surface { albedo = rgb(.123456789, .23456789, .3456789) ior = 1.5  roughness = .123456789  emission = rgb(.1, .2, .3)'
    echo '  radiance = 1.23456789 } }'
    echo 'group { group { prism { outline = [[for (i in 0..<40) <9 * cos(9 * i), 9 * sin(9 * i)>], [<-1, -1>, <1, -1>, <0, 1>]]  from = 0  to = 1'
    echo '  surface = surface { albedo = rgb(.123456789, .23456789, .3456789) ior = 1.5  roughness = .123456789  emission = rgb(.1, .2, .3)'
    echo '  radiance = 1.23456789 } } } }'
    echo 'prism { outline = [[<-2, -2>, <2, -2>, <0, 2>], [<-1, -1>, <1, -1>, <0, 1>]]  from = 0  to = 1  surface = rough }'
    echo 'environment { color = 1 }'
    echo 'camera { from = <0, 5, 30>  to = <0, 0, 0> }'
} > long.mns
same_flat long.mns
end

begin "dump: parameters, presets and --set have taken effect; files are named by their whole path"
small_scene
echo 'preset fine { render { samples = 64 } }' >> small.mns
run dump small.mns -D level=2 --preset fine
says out 'radius = 2'
says out 'samples = 64'
mkdir inner
cp "$root/examples/minirt.mns" inner/
printf 'meniscus 1.0\nmesh { file = "cube.obj"  surface = surface { } }\n' > inner/part.mns
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > inner/cube.obj
printf 'meniscus 1.0 unit mm\ninclude "inner/part.mns"\n' > outer.mns
run dump outer.mns
exits 0
matches out 'file = "/.*/inner/cube.obj"'
printf 'meniscus 1.0 unit mm\nmesh { file = "missing.obj"  surface = surface { } }\n' > outer.mns
run dump outer.mns
exits 3
says err '[file-not-found]'
empty out
end

begin "dump: what a text cannot hold is an error, not a text that cannot be read"
cat > deep.mns <<'SCENE'
meniscus 1.0 unit mm
param depth = 50
def nest(n) { group { if (n > 0) { nest(n - 1) } else { sphere { radius = 1  interior = air } } } }
nest(depth)
environment { color = 1 }
camera { from = <0, 0, 9>  to = <0, 0, 0> }
SCENE
same_flat deep.mns
run dump deep.mns -D depth=200
exits 3
says err 'too deep for a text'
empty out
end

begin "dump: a scene that moves is dumped as the shutter opens, and that is said"
small_scene
sed 's/fov = 30/fov = 30  shutter = 90deg/' small.mns > blurred.mns
echo 'animation { frames = 2 }' >> blurred.mns
run dump blurred.mns
exits 0
says err 'nothing moves in it'
run dump small.mns
empty err
end

begin "dump: combinations that are empty as the shutter opens"
cat > meet.mns <<'SCENE'
meniscus 1.0 unit mm
animation { frames = 2 }
medium g { ior = 1.5 }
intersection lens { sphere { radius = 2 } sphere { radius = 2  translate(<5 - 5 * clock, 0, 0>) } interior = g }
environment { }
camera { from = <0, 0, 9>  to = <0, 0, 0>  shutter = 360deg }
film { size = <8, 8> }
SCENE
run render meet.mns --frame 1 -s 1 -o meet.exr
exits 0
says_not err 'nothing is left'
run dump meet.mns
exits 0
cp out met.mns
run render met.mns -s 1 -o met.exr
exits 0
says err 'warning: nothing is left of lens [nothing-left]'
sed 's/  shutter = 360deg//' meet.mns > apart.mns
run render apart.mns -s 1 -o apart.####.exr
exits 0
there apart.0001.exr
there apart.0002.exr
end
