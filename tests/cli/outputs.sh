# outputs.sh - what is written, where, and what happens when it cannot be.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "the default output: the scene's name in the current folder"
mkdir scenes
small_scene
mv small.mns scenes/
run render scenes/small.mns
exits 0
there small.exr
matches err '^wrote small\.exr \(16 x 16, 4 samples, 0 nesting faults\) in [0-9.]+ s$'
no_leftovers
end

begin "the film's output, and its frames"
small_scene
sed -i 's/size = <16, 16>/size = <16, 16> output = ["f.####.exr", "g.png"]/' small.mns
run render small.mns
exits 0
there f.0001.exr
there g.png
matches err '^wrote f\.0001\.exr and g\.png '
end

begin "EXR and PNG at once, view and display"
small_scene
run render small.mns -o a.exr -o a.png
exits 0
[ "$(head -c 4 a.exr | od -An -tx1 | tr -d ' ')" = 762f3101 ] || flunk "a.exr is no EXR file"
[ "$(head -c 4 a.png | od -An -tx1 | tr -d ' ')" = 89504e47 ] || flunk "a.png is no PNG file"
end

begin "transparent PNG files: alpha as in the EXR file, colours not multiplied by it; off: over black"
cat > ball.mns <<'SCENE'
meniscus 1.0 unit cm
sphere { radius = 1  surface = surface { albedo = 0  emission = .5 } }
environment { color = 1  visible = false }
camera { from = <0, 0, -8>  to = <0, 0, 0>  fov = 20 }
film { size = <24, 24>  alpha = true }
render { samples = 64 }
SCENE
run render ball.mns -o a.exr -o a.png
exits 0
run view a.exr -o viewed.png
exits 0
run render ball.mns -o off.png --alpha off
exits 0
run view a.exr -o black.png --alpha off
exits 0
PYTHONPATH=$root/tests/cli "$python" -B - <<'PYTHON' || flunk "not the pixels that there should be"
from pixels import pixels
a, viewed, off, black = [pixels(name + ".png") for name in ("a", "viewed", "off", "black")]
assert a == viewed and off == black
middle = a[12][12]
assert middle[3] == 255 and off[12][12] == middle[:3]
assert a[0][0] == (0, 0, 0, 0) and off[0][0] == (0, 0, 0)
partial = [p for row in a for p in row if 0 < p[3] < 255]
assert len(partial) > 20, len(partial)
# the ball is as bright at its edge as in its middle, to the noise of colours of a few samples; over black it is darker there
assert all(abs(p[c] - middle[c]) <= (6 if p[3] < 60 else 2) for p in partial for c in range(3)), partial
assert any(off[y][x][0] < middle[0] / 2 for y in range(24) for x in range(24) if 0 < a[y][x][3] < 255)
PYTHON
end

begin "EXR on standard output"
small_scene
"$program" render small.mns -o - > a.exr 2> err
status=$?
exits 0
[ "$(head -c 4 a.exr | od -An -tx1 | tr -d ' ')" = 762f3101 ] || flunk "no EXR file"
run render small.mns -o b.exr
cmp -s a.exr b.exr || flunk "not the file that is written by name"
end

begin "one pixel is rendered, and its values are printed"
small_scene
run render small.mns --pixel 8,5 -s 16 -q
exits 0
matches out '^pixel 8,5$'
matches out '^samples 16$'
for channel in R G B A noise.Y; do matches out "^$channel [0-9.e-]+$"; done
matches out '^display #[0-9a-f]{6}$'
matches out '^R 0*[1-9.]' # there is light
gone small.exr
empty err
run render small.mns --pixel 8,5 -s 16 -q --aov depth -o pixel.exr
matches out '^Z [0-9.]+$'
run render small.mns --crop 8,5,9,6 -s 16 -q --aov depth -o crop.exr --fireflies keep
run compare pixel.exr crop.exr --max-rmse 0
exits 0
run render small.mns --pixel 16,5
exits 2
says err "16,5 is no pixel of the picture, 0,0 to 15,15"
run render small.mns --pixel 5
exits 2
says err "'5' is not X,Y, two whole numbers, such as 320,240"
run render small.mns --pixel 5,5 --crop 1,1,2,2
exits 2
says err "one of them is too many"
end

begin "half is smaller than float; of the two the last one counts"
small_scene
run render small.mns -o float.exr --size 64x64
run render small.mns -o half.exr --half --size 64x64
run render small.mns -o last.exr --half --float --size 64x64
[ "$(wc -c < half.exr)" -lt "$(wc -c < float.exr)" ] || flunk "half.exr is not smaller"
cmp -s float.exr last.exr || flunk "--float does not override --half"
run compare half.exr float.exr --max-rmse 0.002
exits 0
end

begin "attributes say how it was made"
small_scene
run render small.mns -o a.exr --seed 4294967295 --nesting entered
run info a.exr
for fact in 'version ' 'scene +small' 'sceneHash +[0-9a-f]{16}' 'seed +4294967295' 'nesting +entered' 'samples +4' 'noise ' \
    'crossings +[0-9]+' 'nestingFaults +0'; do
    matches out "^meniscus/$fact"
done
run info a.exr --json
is_json out
end

begin "any number of threads gives the same bytes"
small_scene
run render small.mns -o one.exr -j 1 --size 40x30
run render small.mns -o two.exr -j 2 --size 40x30
run render small.mns -o five.exr -j 5 --size 40x30
cmp -s one.exr two.exr || flunk "one and two threads differ"
cmp -s one.exr five.exr || flunk "one and five threads differ"
run render small.mns -o seed.exr --seed 1 --size 40x30
cmp -s one.exr seed.exr && flunk "another seed gives the same bytes"
end

begin "size, scale and crop"
small_scene
run render small.mns -o whole.exr --size 40x30 --scale 50%
says err "(20 x 15,"
run render small.mns -o part.exr --size 20x15 --crop 5,5,10,10
exits 0
says err "(20 x 15,"
run compare whole.exr part.exr
exits 0
for crop in 25%,33.4%,50%,66.6% 5,33.4%,10,10; do
    run render small.mns -o percent.exr --size 20x15 --crop $crop
    exits 0
    cmp -s part.exr percent.exr || flunk "$crop is another part"
done
run render small.mns -o part.exr --size 20x15 --crop 0%,0%,100%,100%
run render small.mns -o whole.exr --size 20x15
cmp -s part.exr whole.exr || flunk "100% is not all"
end

begin "a picture that is larger than the memory says so, and what to do"
small_scene
run render small.mns -o vast.exr --size 65536x65536 -s 1
exits 1
says err "65536 x 65536 pixels need some 1374 GB of memory, and this machine has"
says err "by '--crop', are put together by 'meniscus merge'"
says err "out of memory:"
run render small.mns -o part.exr --size 60000x60000 --crop 30000,40000,30008,40006 -s 1 --caustics off -q
exits 0
no_complaint err
run info part.exr
matches out '^dataWindow +30000 40000  30007 40005$'
run view part.exr -o part.png
exits 4
says err "it holds 8 x 6 pixels of a picture of 60000 x 60000, most of which would be empty; 'meniscus merge'"
end

# cannot TEXT OUTPUT...: status 5 before anything is rendered
cannot() {
    expected=$1
    begin "an output that cannot be written: $2"
    long_scene
    mkdir folder.exr
    shift
    run render long.mns -q "$@"
    exits 5
    says err "$expected"
    no_leftovers
    end
}
cannot "cannot write 'folder.exr': it is a folder" -o folder.exr
cannot "cannot write 'missing/a.exr': there is no folder 'missing'" -o missing/a.exr
cannot "cannot write 'long.mns/a.exr': Not a directory" -o long.mns/a.exr
cannot "cannot write 'missing/s.json'" -o a.exr --stats=missing/s.json

begin "a full disk: status 5"
small_scene
run render small.mns -o /dev/full
exits 5
says err "cannot write '/dev/full': No space left on device"
end

begin "a full disk does not keep the other output from being written"
small_scene
run render small.mns -o /dev/full -o b.exr
exits 5
there b.exr
end

begin "a closed pipe: status 5"
small_scene
{ "$program" render small.mns -o - --size 256x256 -s 1 2> err; echo $? > status; } | true
status=$(cat status)
exits 5
says err "Broken pipe"
end

begin "standard streams that are closed: their numbers are no file's, and standard output is told of"
small_scene
"$program" render small.mns -o - 2> err >&-
status=$?
exits 5
says err "cannot write to standard output: "
"$program" render - < small.mns > out 2> err <&-
status=$?
exits 4
long_scene
"$program" render long.mns -o a.exr -t 2 2>&- &
child=$!
sleep 0.5
[ ! -d /proc/$child/fd ] || [ "$(readlink /proc/$child/fd/2)" = /dev/null ] || flunk "number 2 is another file's"
wait $child
status=$?
exits 0
end

begin "a failed write leaves the old file"
small_scene
echo old > a.exr
mkdir sub
run render small.mns -o a.exr --spp 0
exits 2
[ "$(cat a.exr)" = old ] || flunk "a.exr was changed"
end

begin "statistics"
small_scene
run render small.mns --stats=stats.json -o a.exr
exits 0
is_json stats.json
says stats.json '"nestingFaults": 0'
run render small.mns --stats -o a.exr
matches err '^rays +[0-9]+'
run render small.mns --stats=a.exr -o a.exr
exits 2
says err "'a.exr' is both an output and the statistics"
run render small.mns --stats=- -o -
exits 2
empty out
run render small.mns --stats -o a.exr --log-format json
while read -r line; do printf '%s\n' "$line" > line; is_json line; done < err
says err '"event": "done"'
end

begin "render says where nothing but volumes says which is on top"
cat > drink.mns <<'SCENE'
meniscus 1.0 unit cm
medium glass { ior = 1.5 }
medium wine { ior = 1.33 }
cylinder { from = <0, 0, 0>  to = <0, 9, 0>  radius = 4  interior = glass }
cylinder { from = <0, 8, 0>  to = <0, 10, 0>  radius = 3  interior = wine }
environment { color = 1 }
camera { from = <0, 12, 30>  to = <0, 4, 0> }
SCENE
run render drink.mns -o a.exr -s 1 --size 4x3
says err order-by-volume
run render drink.mns -o a.exr -s 1 --size 4x3 --set wine.state=liquid --set glass.state=solid
says_not err order-by-volume
end

begin "what is scattered crosses no surface, and render says where that takes very long"
cat > milk.mns <<'SCENE'
meniscus 1.0 unit cm
medium milk { ior = 1  scattering = 30 / 1cm }
param inside = false
sphere { radius = 4  interior = milk }
environment { color = 1 }
camera { from = inside ? <0, 1, 2> : <0, 0, 20>  to = <0, 0, 0>  fov = 30  expect = inside ? [milk] : [] }
SCENE
run render milk.mns -o a.exr -s 8 --size 20x15 --stats=s.json
exits 0
says_not err many-scatterings
"$python" - <<'PYTHON' || flunk "crossings are not surfaces"
import json
stats = json.load(open("s.json"))
assert 0 < stats["crossings"] <= 2 * stats["paths"] < stats["rays"] / 8, stats
PYTHON
run render milk.mns -o a.exr -s 1 --size 4x3 -D inside=true
says err 'many-scatterings'
end

begin "a time limit ends a render with status 0"
long_scene
run render long.mns -o a.exr -t 0.3s --progress none
exits 0
there a.exr
matches err 'samples? of|[0-9]+ of 16777216 samples'
run render long.mns --size 3000x2000 -o a.exr -t 0.001 --aov samples --progress none
exits 0
matches err '^wrote a\.exr \(3000 x 2000, one sample in [0-9.]+ % of the pixels, '
end

begin "a medium without an end that takes no light: it is warned of, and the render ends"
cat > endless.mns <<'SCENE'
meniscus 1.0 unit cm
world { medium = medium { ior = 1  scattering = .2 } }
sphere { radius = 1  surface = surface { albedo = .8  emission = 1 } }
camera { from = <0, 2, 8>  to = <0, 0, 0>  fov = 30 }
film { size = <6, 4> }
SCENE
timeout -s KILL 120 "$program" render endless.mns -o endless.exr -s 1 > out 2> err
status=$?
exits 0
says err "[endless-scattering]"
says err "wrote endless.exr"
end

begin "noise ends a render"
long_scene
run render long.mns -o a.exr -n 50% --progress none
exits 0
there a.exr
end

begin "an aim of noise that is missed is said, and what gives light beside lights"
cat > lit.mns <<'SCENE'
meniscus 1.0 unit cm
surface glowing { emission = 300 }
sphere { radius = .3  surface = surface { } }
for (i in [-1, 1]) { sphere { center = <2 * i, 2, 0>  radius = .02  surface = glowing } }
sphere { radius = .3  center = <0, -1, 0>  interior = medium { ior = 1  emission = .1 } }
camera { from = <0, 0, 5>  to = <0, 0, 0> }
film { size = <32, 32> }
render { samples = 4 }
SCENE
run render lit.mns -o a.exr --noise 2% --progress none -v
exits 0
matches err 'lights: 0, and 3 objects that shine; '
matches err 'remark: a noise of 2 % was aimed at, and [0-9.]+ % was reached, as no pixel gets more than 4 samples: .--spp. allows more$'
run render lit.mns -o a.exr --noise 2% --progress none -q
says_not err aimed
run render lit.mns -o a.exr --noise 2% --progress none --set 'glowing.emission=.1' --stats=a.json
exits 0
says_not err aimed
says a.json '"objectsThatShine": 3'
small_scene
run render small.mns -o a.exr -s 1 -v
matches err 'lights: 0; '
end

begin "noise is in relation to what the picture is shown with"
cat > room.mns <<'SCENE'
meniscus 1.0 unit m
param dim = 0 "by how many stops all light is less"
let light = 2 ^ -dim
sphere { center = <0, 1, 0>  radius = 1  surface = surface { albedo = .5 } }
ground { surface = surface { albedo = .4 } }
light { shape = "sphere"  from = <3, 5, 2>  radius = .3  radiance = 40 * light }
environment { color = .02 * light }
camera { from = <0, 2, 6>  to = <0, 1, 0> }
film { size = <32, 24>  exposure = dim }
SCENE
noise_of() { run render room.mns -o room.exr --noise .5% -s 1000 --progress none "$@" && cat err; }
noise_of -D dim=0 > bright.txt
noise_of -D dim=6 > dim.txt
noise_of -D dim=6 --set film.exposure=0 --exposure 6 > asked.txt
sed -i 's/ in [0-9.]* s$//' bright.txt dim.txt asked.txt
cmp -s bright.txt dim.txt || flunk "a film that is exposed for less light asks for other samples"
cmp -s bright.txt asked.txt || flunk "the option asks for other samples than the film"
for dim in 0 6; do
    run render room.mns -o "few-$dim.exr" -q -s 4 -D "dim=$dim"
    run render room.mns -o "many-$dim.exr" -q -s 400 -D "dim=$dim"
    run compare "few-$dim.exr" "many-$dim.exr" --flip
    awk '/^(relative|flip)/ { printf "%s %.3g\n", $1, $NF }' out > "compared-$dim.txt"
done
cmp -s compared-0.txt compared-6.txt || flunk "compare tells other differences where a film is exposed for less light"
matches out '^white +0\.015625$'
run compare few-0.exr many-0.exr
says_not out white
run render room.mns -o a.exr -q -D dim=6 --set film.exposure=0 --noise .5% -s 1000 --aov samples && run info a.exr
matches out '^meniscus/meanSamples +16$'
run render room.mns -o b.exr -q -D dim=6 --set film.exposure=0 --auto-exposure on --noise .5% -s 1000 --aov samples && run info b.exr
matches out '^meniscus/meanSamples +1[0-9][0-9]'
end

begin "adaptive renders: the samples of noisy and of quiet pixels, and their mean"
small_scene
run render small.mns -o a.exr -s 64 --adaptive on --aov samples --stats=a.json --progress none
exits 0
matches err '^wrote a\.exr \(16 x 16, [0-9]+ to [0-9]+ samples, 6[345](\.[0-9])? on average, noise '
run info a.exr
says out "samples float"
matches out '^meniscus/meanSamples +6[345]'
run render small.mns -o b.exr --set render.adaptive=true -s 64 --aov samples -j 1 -q
cmp -s a.exr b.exr || flunk "it depends on the threads, or on who says it"
run render small.mns -o c.exr --set render.adaptive=true --adaptive off -s 64 --aov samples -q
run render small.mns -o d.exr -s 64 --aov samples -q
cmp -s c.exr d.exr || flunk "it is not off"
run render small.mns -o c.exr -s 8 --adaptive on --progress none
exits 0
run render small.mns -o c.exr -s 3 --adaptive on --progress none
exits 0
matches err '3 to 3 samples, 3 on average'
run render small.mns --adaptive sometimes
exits 2
says err "'sometimes' is not one of on or off"
end

begin "aov: the coordinates of a mesh are those of its file"
printf '%s\n' 'v -2 -2 0' 'v 2 -2 0' 'v 2 2 0' 'v -2 2 0' 'vt .25 0' 'vt .75 0' 'vt .75 1' 'vt .25 1' 'f 1/1 2/2 3/3' 'f 1/1 3/3 4/4' > square.obj
cat > square.mns <<'SCENE'
meniscus 1.0 unit cm
mesh { file = "square.obj"  surface = surface { } }
environment { }
camera { projection = orthographic  width = 2  from = <0, 0, 5>  to = <0, 0, 0> }
film { size = <101, 101>  aovs = "uv" }
SCENE
run render square.mns --pixel 25,50 -s 16 -q
exits 0
matches out '^uv\.U 0\.43[78]'
matches out '^uv\.V 0\.(49|50)'
end

begin "aov: the coordinates of a box are those that pictures take"
cat > sides.mns <<'SCENE'
meniscus 1.0 unit cm
difference {
  box { size = <4, 4, 4> }
  sphere { radius = .1  center = <1.9, 1.9, 1.9> }
  surface = surface { }
  scale(<1, 2, 1>)
}
environment { }
camera { projection = orthographic  width = 2  from = <0, 0, 5>  to = <0, 0, 0> }
film { size = <101, 101>  aovs = "uv" }
SCENE
run render sides.mns --pixel 0,100 -s 16 -q
exits 0
matches out '^uv\.U 0\.25[23]'
matches out '^uv\.V 0\.37[56]'
sed 's/scale(<1, 2, 1>)/rotate(y, 180)/' sides.mns > behind.mns
run render behind.mns --pixel 0,100 -s 16 -q
exits 0
matches out '^uv\.U 0\.25[23]'
matches out '^uv\.V 0\.25[23]'
end

begin "aov: spectra, as programs that know spectral EXR files read them, and as numbers of a pixel"
small_scene
run render small.mns -o a.exr --aov spectrum
exits 0
run info a.exr
for nm in 400 550 700; do says out " S0.${nm}nm float"; done
matches out '^spectralLayoutVersion +1\.0$'
matches out '^emissiveUnits +W\.m\^-2\.sr\^-1$'
run view a.exr --layer S0.550nm -o a.png
exits 0
run render small.mns --pixel 8,5 --aov spectrum -q
[ "$(grep -c '^S0\.[4-7][0-9]0nm [0-9]' out)" -eq 31 ] || flunk "not 31 bands"
end

begin "aov: the light of each group of lights, also of parts that are merged, and pictures with other lights"
cat > groups.mns << END
meniscus 1.0 unit cm
medium water { ior = 1.33  state = liquid }
sphere { interior = water  radius = 1 }
ground { y = -1  surface = surface { albedo = .5 } }
environment { color = rgb(.3, .4, .5)  light_group = "sky" }
light { shape = sphere  from = <4, 9, 2>  radius = 1  radiance = 30  light_group = "key" }
light { shape = sphere  from = <-4, 9, 2>  radius = 1  radiance = 9 }
camera { from = <0, 2, 8>  to = <0, 0, 0>  fov = 30 }
film { size = <24, 16>  aovs = [lights] }
render { samples = 16  denoise = true }
END
run render groups.mns -o g.exr
exits 0
run info g.exr
for group in key other sky; do says out " lights.$group.R float"; done
run render groups.mns --pixel 3,9 -q
matches out '^lights\.key\.G [0-9.]+$'
run render groups.mns -o g1.exr --sample-range 1..7
run render groups.mns -o g2.exr --sample-range 8..16
run merge g1.exr g2.exr -o g3.exr
exits 0
run compare g.exr g3.exr --max-rmse 0
exits 0
run view g3.exr --layer lights.key -o a.png
run view g.exr --layer lights.key -o b.png
exits 0
cmp -s a.png b.png || flunk "layers of lights differ in what was merged"
run view g.exr --layer lights -o c.png
exits 4
says err "name one of them: lights.key, lights.other, lights.sky"
sed 's/"sky"/"dome"/' groups.mns > other.mns
run render other.mns -o g4.exr --sample-range 8..16
run merge g1.exr g4.exr -o g5.exr
exits 4
run view g.exr -o plain.png
run view g.exr -o same.png --light key=1 --light sky=1,1,1
exits 0
cmp -s plain.png same.png || flunk "lights that are not changed change the picture"
run view g.exr -o dark.png --light key=0 --light sky=0 --light other=0
run view g.exr -o darker.png --light key=0 --light sky=0 --light other=0 --exposure 5
cmp -s dark.png darker.png || flunk "without lights it is not dark"
run view g.exr -o x.png --light keys=2
exits 4
says err "the picture has no group of lights 'keys', only: key, other, sky; did you mean 'key'?"
for wrong in key key= =2 key=2,3 key=1,2,3,4 key=-1 key=red; do
    run view g.exr -o x.png --light "$wrong"
    exits 2
    says err "'--light $wrong' is not GROUP=FACTOR"
done
run view plain.png -o x.png --light key=2
exits 4
says err "the picture has no layers of lights"
end

begin "aov: further channels"
small_scene
run render small.mns -o plain.exr
run render small.mns -o a.exr --aov normal,depth,nesting,cryptomatte
exits 0
run info a.exr
for channel in N.X N.Z Z nesting.silent CryptoObject00.R CryptoMaterial02.A; do says out " $channel float"; done
says_not out "albedo"
matches out '^cryptomatte/[0-9a-f]{7}/manifest +\{.*"sphere 1": "[0-9a-f]{8}"'
run compare a.exr plain.exr --max-rmse 0
exits 0
run render small.mns -o b.exr --aov normal,depth,nesting,cryptomatte -j 1
cmp -s a.exr b.exr || flunk "the channels depend on the number of threads"
sed -i 's/size = <16, 16>/size = <16, 16> aovs = ["medium"]/' small.mns
run render small.mns -o c.exr
run info c.exr
says out "medium.G float"
says out '"water"'
run render small.mns -o c.exr --aov normals
exits 2
says err "there is no 'normals'; did you mean 'normal'?"
run render small.mns -o c.png --aov depth
exits 0
says err "warning: '--aov': channels are kept in EXR files, and no output is one"
run render small.mns -o c.exr --aov all --half
says_not err warning
exits 0
run info c.exr
says out "R half"
says out "Z float"
end

begin "single bright samples: spread, or kept; the light is the same"
cat > glints.mns <<'SCENE'
meniscus 1.0 unit mm
medium glass { ior = 1.5  state = solid }
ground { surface = surface { albedo = .5 } }
sphere { center = <0, 1, 0>  radius = 1  interior = glass }
environment { strength = .05 }
light { shape = sphere  from = <3, 6, 2>  radius = .2  radiance = 300 }
camera { from = <0, 3, 8>  to = <0, 1, 0>  fov = 30 }
film { size = <40, 30> }
render { samples = 32  caustics = off }
SCENE
run render glints.mns -o spread.exr --stats=spread.json
exits 0
matches err '^wrote spread\.exr \(40 x 30, 32 samples, [0-9.]+ % of the light spread, 0 nesting faults\) in '
run render glints.mns -o keep.exr --fireflies keep --stats=keep.json
exits 0
matches err '^wrote keep\.exr \(40 x 30, 32 samples, 0 nesting faults\) in '
"$python" - <<'PYTHON' || flunk "the statistics"
import json
spread, keep = json.load(open("spread.json")), json.load(open("keep.json"))
assert spread["samplesSpread"] > 0 and 0 < spread["lightSpread"] < 1, spread
assert keep["samplesSpread"] == 0 and keep["lightSpread"] == 0 and keep["rays"] == spread["rays"], keep
PYTHON
run compare spread.exr keep.exr
[ "$(grep '^mean of A' out | cut -c 10-)" = "$(grep '^mean of B' out | cut -c 10-)" ] || flunk "the means differ"
says_not out "rmse                0 "
sed 's/<0, 1, 0>  radius = 1/<0, 2, 0>  radius = 1/; s/<3, 6, 2>  radius = .2/<0, 2, 0>  radius = .1/; s/<0, 3, 8>  to = <0, 1, 0>/<0, 6, 8>  to = <0, 0, 2>/' glints.mns > bulb.mns
run render bulb.mns -o bulb.exr
matches err "remark: [0-9.]+ % of the light came by few .* '--caustics on' looks where such light is, and '--fireflies keep'"
says_not err "which is usual"
run render bulb.mns -o bulb.exr --spp 16
matches err "remark: [0-9.]+ % of the light came by few samples, which is usual where each pixel has no more than 16 of them, and"
run render bulb.mns -o bulb.exr --fireflies keep
says_not err "of the light came by"
run render glints.mns -o set.exr --set render.fireflies=keep -q
run compare set.exr keep.exr --max-rmse 0
exits 0
run info spread.exr
says out "meniscus/lightSpread"
run info keep.exr
says_not out "meniscus/lightSpread"
run render glints.mns -o smooth.exr --denoise on --stats=smooth.json
exits 0
says err 'light spread, denoised, 0 nesting faults'
run compare smooth.exr spread.exr
says_not out "rmse                0 "
"$python" - <<'PYTHON' || flunk "the statistics of a denoised picture"
import json
smooth, spread = json.load(open("smooth.json")), json.load(open("spread.json"))
assert smooth["denoised"] is True and spread["denoised"] is False
assert smooth["rays"] == spread["rays"] and smooth["noise"] == spread["noise"], "the same samples"
PYTHON
run render glints.mns -o set.exr --set render.denoise=true -q
run compare set.exr smooth.exr --max-rmse 0
exits 0
run render glints.mns -o off.exr --set render.denoise=true --denoise off -q
run compare off.exr spread.exr --max-rmse 0
exits 0
run info smooth.exr
says out "meniscus/denoised"
run render glints.mns --denoise maybe
exits 2
says err "not one of on or off"
run render glints.mns --fireflies drop
exits 2
says err "spread"
end

begin "a picture that is white all over: a remark, with what to do; for EXR alone where nothing of it is to be seen, and none where it is not"
small_scene
sed -e 's/environment { color = 1 }/environment { color = 1000 }/' small.mns > white.mns
run render white.mns -o white.png
exits 0
says err "remark: half of the picture is 8 stops or more above white: give it 512 times less light"
says err ", or film { exposure = -9 }"
run render white.mns -o white.png --exposure -7
says err "half of the picture is 1 stop or more above white: give it 4 times less light"
run render white.mns -o white.png --exposure -9
says_not err "above white"
run render white.mns -o white.png -q
says_not err "above white"
run render white.mns -o white.exr
says err "half of the picture is 8 stops or more above white: give it 512 times less light, or: meniscus view white.exr -o FILE.png --exposure -9"
run render white.mns -o white.exr --exposure -9
says_not err "above white"
{ cat white.mns; echo 'box { from = <-9, 0, -9>  to = <0, 19, -8>  surface = surface { albedo = 0 } }'; } > half.mns
run render half.mns -o half.exr
says_not err "above white"
run render half.mns -o half.exr -o half.png
says err "above white"
run render small.mns -o small.png
says_not err "above white"
end

begin "--auto-exposure: PNG files are as bright as the picture asks for, and by which exposure is said; --exposure comes on top"
small_scene
sed -e 's/environment { color = 1 }/environment { color = 1000 }/' small.mns > white.mns
run render small.mns -o plain.exr
run render white.mns -o white.exr -o white.png --auto-exposure on
exits 0
says_not err "above white"
stops=$(sed -n 's/.*, exposure \(-[0-9.]*\), .*/\1/p' err)
run view white.exr -o by-number.png --exposure "$stops"
exits 0
cmp -s white.png by-number.png || flunk "--exposure $stops is another picture"
run view white.exr -o viewed.png --auto-exposure on
says err "remark: the automatic exposure is the same as: --exposure $stops"
cmp -s white.png viewed.png || flunk "view chooses another exposure"
run render white.mns -o scene.png --set film.auto_exposure=true
cmp -s white.png scene.png || flunk "the scene's auto_exposure is another one"
run render white.mns -o off.png --set film.auto_exposure=true --auto-exposure off
says err "above white"
run view white.exr -o brighter.png --auto-exposure on --exposure 1
says err "--exposure $(awk "BEGIN { print $stops + 1 }")"
run render white.mns -o white.png --auto-exposure on --log-format json
says err "\"exposure\": $stops"
run render white.mns --pixel 5,5 --auto-exposure on
exits 0
says_not out "display"
run view white.exr -o none.png --exposure auto
exits 2
says err "option '--exposure' is a number; write: --auto-exposure on"
end

begin "a part of an orthographic picture that is inside of an opaque object: a remark"
cat > cut.mns <<'SCENE'
meniscus 1.0 unit cm
union { box { size = <4, 4, 4> }  sphere { radius = 2.5 }  surface = surface { } }
camera { projection = orthographic  width = 12  from = <0, 0, 0>  to = <0, 0, -1> }
environment { color = .5 }
film { size = <32, 24> }
render { samples = 4 }
SCENE
run render cut.mns -o cut.png
exits 0
says err "of the picture plane of camera 1 is inside of union 1, which is opaque"
run render cut.mns -o cut.png -q
says_not err "is opaque"
end

begin "--white-balance: light of that temperature is white in PNG files; EXR files keep it, and note what their film says"
cat > warm.mns <<'SCENE'
meniscus 1.0 unit m
sphere { radius = 1  surface = surface { albedo = .5 } }
environment { color = blackbody(2700) }
camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = 20 }
film { size = <8, 8>  white_balance = 2700 }
render { samples = 16 }
SCENE
spread() { "$python" -c 'import re; h = re.search("display #(.*)", open("out").read())[1]; v = [int(h[i:i + 2], 16) for i in (0, 2, 4)]; print(max(v) - min(v))'; }
run render warm.mns --pixel 4,4
[ "$(spread)" -le 4 ] || flunk "not grey: $(cat out)"
run render warm.mns --pixel 4,4 --white-balance off
[ "$(spread)" -ge 40 ] || flunk "grey without a balance: $(cat out)"
run render warm.mns -o warm.exr -o warm.png -q
run view warm.exr -o viewed.png
cmp -s warm.png viewed.png || flunk "view does not know the film's white balance"
run view warm.exr -o off.png --white-balance off
run render warm.mns -o plain.png -q --white-balance off
cmp -s off.png plain.png || flunk "off is not the same in view and render"
cmp -s off.png warm.png && flunk "a white balance changes nothing"
run view warm.exr -o other.png --white-balance 5000K
exits 0
for wrong in 0 999 40001 warm 2700C; do
    run view warm.exr -o other.png --white-balance $wrong
    exits 2
    says err "is not a temperature from 1000 to 40000 kelvin, such as 2700, or off"
done
run render warm.mns -o part1.exr --sample-range 1..8 -q
run render warm.mns -o part2.exr --sample-range 9..16 -q
run merge -o merged.png part1.exr part2.exr
cmp -s merged.png warm.png || flunk "merge does not know the film's white balance"
run check warm.mns --set film.white_balance=500
exits 3
end

begin "a picture that is nearly black: a remark, with what to do; for EXR alone where nothing of it is to be seen; none where a little of it is bright, nor with -q"
cat > dim.mns <<'SCENE'
meniscus 1.0 unit cm
camera { from = <0, 20, 60>  to = <0, 0, 0> }
ground { surface = surface { } }
sphere { radius = 5  center = <0, 5, 0>  surface = surface { albedo = #f00 } }
light { shape = point  from = <300, 300, 300>  intensity = .1 }
film { size = <32, 24> }
render { samples = 4 }
SCENE
run render dim.mns -o dim.png
exits 0
matches err 'remark: the picture is nearly black: its mean luminance is [0-9.e-]+, where white is 1: give it [0-9.e+]+ times more light, or film \{ exposure = [0-9]+ \}$'
run render dim.mns -o dim.exr -o dim.png
stops=$(sed -n 's/.*or: meniscus view dim\.exr -o dim\.png --exposure //p' err)
[ "$stops" -ge 5 ] || flunk "$stops stops"
run view dim.exr -o bright.png --exposure "$stops"
exits 0
run render dim.mns -o dim.exr
says_not err "nearly black"
sed -e 's/intensity = .1/intensity = .0001/' dim.mns > dimmest.mns
run render dimmest.mns -o dimmest.exr
exits 0
stops=$(sed -n 's/.*the picture is nearly black: .*or: meniscus view dimmest\.exr -o FILE\.png --exposure //p' err)
[ "${stops:-0}" -ge 15 ] || flunk "$stops stops"
run render dim.mns -o dim.exr --preview shown.png
says err "nearly black"
run render dim.mns -o dim.png -q
[ ! -s err ] || flunk "something is said with -q"
run render dim.mns -o dim.png --log-format json --progress none
while read -r line; do printf '%s\n' "$line" > line; is_json line; done < err
matches err '^\{"event": "remark", "message": "the picture is nearly black: '
{ cat dim.mns; echo 'light { shape = sphere  radius = 1.5  from = <-12, 8, 0>  radiance = 1 }'; } > lamp.mns
run render lamp.mns -o lamp.png
says_not err "nearly black"
run render dim.mns -o dim.png --crop 0,0,4,4
says_not err "nearly black"
end

begin "a picture that is nearly black, of a large scene whose first line has no unit: what is written if millimetres are meant"
cat > metres.mns <<'SCENE'
meniscus 1.0
sphere { radius = 5  surface = surface { albedo = .5 } }
light { shape = point  from = <0, 30, 30>  power = 100 }
camera { from = <0, 0, 60> }
film { size = <64, 48> }
render { samples = 4 }
SCENE
run render metres.mns -o metres.exr
exits 0
matches err 'has no unit: lengths are metres then, and it is 6[0-9.]+ m across, .* write: meniscus 1.0 unit mm$'
run render metres.mns -o metres.exr -q
empty err
for unit in m mm; do
    sed "1s/\$/ unit $unit/" metres.mns > "$unit.mns"
    run render "$unit.mns" -o "$unit.exr"
    says_not err 'has no unit'
done
sed -e '1s/$/ unit m/' -e 's/<0, 30, 30>  power = 100/<0, 300, 300>  power = 10/' metres.mns > stated.mns
run render stated.mns -o stated.exr
matches err "has 'unit m': lengths are metres, and it is 6[0-9.]+ m across, .* write: meniscus 1.0 unit mm\$"
sed 's/power = 100/power = 1000000/' metres.mns > bright.mns
run render bright.mns -o bright.exr
says_not err 'has no unit'
end

begin "a picture that is black all over: a warning, once, but not where the scene has no light, which is said, nor of the rest of a crop"
small_scene
{ cat small.mns; echo 'box { from = <-99, -99, -99>  to = <99, 99, 99>  surface = surface { } }'; } > black.mns
run render black.mns -o black.png
exits 0
says err "warning: all of the picture is black: the camera is inside of an opaque object"
matches err "'meniscus check black.mns --pixel [0-9]+,[0-9]+'"
run render black.mns -o black.png --size 10x6
says err "'meniscus check black.mns --size 10x6 --pixel 5,3'"
there black.png
sed -e '/environment/d' small.mns > away.mns
echo 'light { shape = sphere  from = <500, 20, 0>  radius = 1  power = 1 }' >> away.mns
run render away.mns -o away.png --set 'camera.from=<0, 50, 0>' --set 'camera.to=<0, 99, 1>'
says err "warning: all of the picture is black: the camera looks past all that there is, and around it nothing shines"
run render black.mns -o black.exr -q --log-format json
matches err '"warning".*all of the picture is black'
run render black.mns -o black.#.exr --set animation.frames=3
[ "$(grep -c 'all of the picture' err)" -eq 1 ] || flunk "not once"
run render small.mns -o small.png --crop 0,0,2,2
says_not err "is black"
sed -e '/environment/d' small.mns > dark.mns
run render dark.mns -o dark.png
says_not err "all of the picture"
end

begin "what was read is not written over, nor one file made of two, whatever they are called"
small_scene
run render small.mns -o tex.png -q
cat > textured.mns <<'SCENE'
meniscus 1.0
sphere { radius = 1  surface = surface { albedo = image { file = "tex.png"  projection = spherical } } }
environment { strength = .5 }
camera { from = <0, 0, 6>  to = <0, 0, 0>  fov = 30 }
film { size = <16, 12> }
render { samples = 2 }
SCENE
ln -s tex.png link.png
ln tex.png hard.png
cp textured.mns scene.exr
cp small.mns kept.mns
cp textured.mns before.mns
cp tex.png before.png
# clashes TEXT ARGUMENT...: status 2, and TEXT on standard error
clashes() { wanted=$1; shift; run "$@"; exits 2; says err "$wanted"; }
read_it='is not written over: it was read for this'
for spelling in tex.png ./tex.png "$PWD/tex.png" link.png hard.png; do
    clashes "'$spelling' $read_it" render textured.mns -o "$spelling"
done
clashes "$read_it" render textured.mns -o a.exr --stats=textured.mns
clashes "$read_it" render textured.mns -o a.exr --preview tex.png
clashes "'scene.exr' $read_it" render scene.exr
run render small.mns -o sky.exr -q
exits 0
cp sky.exr before.exr
sed -e 's/environment {.*/environment { image = "sky.exr" }/' textured.mns > sky.mns
for spelling in sky.exr ./sky.exr "$PWD/sky.exr"; do clashes "'$spelling' $read_it" render sky.mns -o "$spelling"; done
clashes "'sky.exr' $read_it" render sky.mns
cmp -s before.exr sky.exr || flunk "the sky was changed"
clashes "$read_it" check textured.mns --slice z=0 --slice-output tex.png
clashes "is both what is viewed and the output" view tex.png -o link.png
clashes "is named twice" render small.mns -o a.exr -o ./a.exr
clashes "is both an output and the statistics" render small.mns -o a.exr --stats="$PWD/a.exr"
clashes "is both an output and the preview" render small.mns -o a.exr --preview ./a.exr
clashes "is both the checkpoint and the statistics" render small.mns -o a.exr --checkpoint 1h --stats=./a.checkpoint.exr
clashes "is both the checkpoint and the preview" render small.mns -o a.exr --checkpoint 1h --preview a.checkpoint.exr
gone a.exr
run render small.mns -o a.exr -q --sample-range 1..1
exits 0
clashes "is both an input and the output" merge a.exr -o ./a.exr
cmp -s before.mns textured.mns || flunk "the scene was changed"
cmp -s before.png tex.png || flunk "the texture was changed"
cmp -s before.mns scene.exr || flunk "the scene of another name was changed"
run render textured.mns -o a.exr -q
exits 0
no_leftovers
end

begin "a colour configuration that is not there is told at once, whether a picture needs it or not"
small_scene
run render small.mns -s 1 -o a.exr
exits 0
for command in "render small.mns -s 1 -o b.exr" "check small.mns" "params small.mns" "dump small.mns" "merge a.exr -o b.exr"; do
    # shellcheck disable=SC2086
    run $command --ocio nothing.ocio
    exits 4
    matches err "cannot read .*'nothing.ocio'"
    gone b.exr
done
end
