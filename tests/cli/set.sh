# set.sh - --set and --preset: settings of a scene from the command line.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "--set: a setting, a type, a name, whatever the scene says"
small_scene
run dump small.mns --set render.samples=8 --set camera.fov=20 --set side.fov=0.2turn --set glass.ior=1.6
exits 0
says out 'render { samples = 8 }'
says out 'fov = 20'
says out 'fov = 72'
says out 'medium glass { ior = 1.6 '
run render small.mns --set render.samples=2 --set film.output='"a.exr"'
exits 0
there a.exr
run info a.exr
matches out 'samples.* 2$'
end

begin "--set: names that the scene declares can be used, and the last one counts"
small_scene
run dump small.mns --set sphere.interior=water --set 'ground.y=-level' --set render.samples=1 --set render.samples=3
exits 0
says_not out 'interior = glass'
says out 'y = -3'
says out 'samples = 3'
end

begin "--set: prototypes, instances, nodes that macros make, settings that the scene leaves out"
cat > nodes.mns <<'SCENE'
meniscus 1.0 unit mm
let grey = surface { albedo = .5 }
let ball = sphere { radius = 1  surface = grey }
def post(r) { box { size = <r, 9, r>  surface = grey } }
ball { translate(x) }
ball { radius = 3 }
post corner { r = 2 }
for (i in 1..2) { sphere bead { radius = i  surface = grey } }
SCENE
run dump nodes.mns --set ball.radius=7 --set corner.size='<5, 5, 5>' --set bead.radius=4 --set film.size='<8, 8>'
exits 0
says out 'let ball = sphere { radius = 7 '
says out 'sphere { radius = 3 '
says out 'size = <5, 5, 5>'
says out 'sphere bead__2 { radius = 4 '
says out 'film { size = <8, 8> }'
run dump nodes.mns --set sphere.radius=6
says_not out 'radius = 3'
says_not out 'radius = 1'
end

begin "--set: mistakes point into the words of the command line"
small_scene
run check small.mns --set camera.fow=30 --set gloss.ior=2 --set side.fov=3mm --set render.samples=1.5 --set film.size=1
exits 3
says err "--set:1:8: error: 'camera' has no property 'fow' [unknown-property]"
says err "did you mean 'fov'?"
says err "the scene has no node 'gloss' [unknown-node]"
says err "did you mean 'glass'?"
says err '[wrong-unit]'
says err "'samples' wants a whole number"
matches err '5 errors'
run check small.mns --set fov=30
exits 3
says err '--set takes NODE.PROPERTY=VALUE'
run check small.mns --set 'camera.fov=(30'
exits 3
says err '--set:1:'
end

begin "--preset applies its settings, and --set comes after it"
small_scene
echo 'preset draft { render { samples = 1 }  film { size = <8, 4> } }' >> small.mns
run render small.mns --preset draft -o a.exr
exits 0
run info a.exr
matches out 'samples.* 1$'
matches out '^dataWindow +0 0  7 3'
run dump small.mns --preset draft --set render.samples=5
says out 'samples = 5'
says out 'size = <8, 4>'
run check small.mns --preset drift
exits 3
says err "did you mean 'draft'?"
end

begin "--set: what is turned off by 0 may keep what says how it works; what was never turned on may not"
cat > off.mns <<'SCENE'
meniscus 1.0 unit cm
param much = 0
camera { from = <0, 0, -10>  to = <0, 0, 0>  aperture = much  focus = <0, 0, 0>  shutter = 180 * much  shutter_steps = 3 }
surface cloth { albedo = noise { turbulence = much  turbulence_octaves = 3 }  fuzz = much  fuzz_roughness = .5 }
surface paint { albedo = .5  metalness = much  roughness = .3  anisotropy = much  grain = x  coat = much  coat_tint = rgb(.9, .8, .7) }
sphere { radius = 1  surface = paint }
box { from = <2, 0, 0>  to = <3, 1, 1>  bevel = .1 * much  bevel_segments = 3  surface = cloth }
environment { }
SCENE
for much in 0 .5; do
    run check off.mns -D much=$much
    exits 0
    empty err
done
run check off.mns -D much=.5 --set camera.aperture=0 --set camera.shutter=0 --set surface.coat=0
exits 0
sed -i 's/aperture = much//; s/coat = much//' off.mns
run check off.mns -D much=.5
exits 3
says err "'focus' has no effect without an aperture"
says err "'coat_tint' has no effect without a coat"
end

begin "-D clock=.5: the clock has an option of its own"
small_scene
run check small.mns -D clock=.5
exits 3
says err "hint: that of the frame is set by --clock"
end

begin "-D and --set: blanks around the '='"
small_scene
echo 'param count = 3' >> small.mns
run render small.mns -D 'count = 2' --set 'camera.fov = 20' -o a.exr
exits 0
run render small.mns -D count=2 --set camera.fov=20 -o b.exr
exits 0
run compare a.exr b.exr --max-rmse 0
exits 0
end

begin "-D: words and numbers in place of colours, truths and vectors"
small_scene
printf '%s\n' 'param c = #ff0000' 'param on = true' 'param pos = <1, 2, 3>' 'sphere { center = pos  surface = surface { albedo = c } }' 'if (on) { }' >> small.mns
run check small.mns -D c=red
exits 3
says err 'hint: write: rgb(1, 0, 0)'
run check small.mns -D on=1
exits 3
says err 'hint: write: true'
run check small.mns -D pos=1,2,3
exits 3
says err "hint: a vector stands in '<' and '>'"
end

begin "--set: of two near names the one that the scene declares is meant; transforms are for -D"
small_scene
sed -i 's/^camera {/light fill { shape = sphere  radius = 1  from = <0, 9, 0> }\ncamera {/' small.mns
run check small.mns --set fil.x=1 --set fill.translate='<1, 2, 3>' --set sphere.rotate=4
exits 3
says err "the scene has no node 'fil'"
says err "did you mean 'fill'?"
says err "hint: --set sets no transforms; write in the scene: param place = <0, 0, 0>, in the node: translate(place), and set it by -D place='<1, 2, 3>'"
says err "param turn = 0, in the node: rotate(y, turn), and set it by -D turn=45"
says_not err "without '='"
# what it says works
sed -i 's/^light fill {/param place = <0, 0, 0>\nlight fill { translate(place) /' small.mns
run check small.mns -D place='<1, 2, 3>'
exits 0
end

begin "-D: a value that is out of range is shown with its unit, and so is the range"
cat > units.mns <<'SCENE'
meniscus 1.0 unit cm
param level = 3cm in 1..5
param turn = 30 in 0..90deg
param number = 3 in 1..5
param sizes = <1cm, 2cm>
param kind = 2cm in [1cm, 2cm, 25mm]
sphere { radius = level + number + sizes.x + kind  surface = surface { }  rotate(y, turn) }
environment { }
camera { from = <0, 0, 50>  to = <0, 0, 0> }
SCENE
run check units.mns
exits 0
run check units.mns -D level=90mm -D turn=.5turn -D number=9 -D kind=3
exits 3
says err "parameter 'level' is 9cm, outside of 1cm..5cm ["
says err "parameter 'turn' is 180deg, outside of 0deg..90deg ["
says err "parameter 'number' is 9, outside of 1..5 ["
says err "parameter 'kind' is 3cm, outside of [1cm, 2cm, 2.5cm] ["
printf 'assert(level < 5cm, "too high")\n' >> units.mns
run check units.mns -D level=90mm
exits 3
[ "$(grep -n 'error:' err | head -1 | cut -d: -f2)" = -D ] || flunk "what the command line says is not the first mistake"
run check units.mns -D number=90mm
exits 3
says err "parameter 'number' is 9cm, outside of 1cm..5cm ["
end
