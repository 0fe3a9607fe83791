# usage.sh - options and commands: what is refused, and how it is said.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# refuses TEXT ARGUMENT...: status 2, nothing on standard output, TEXT on standard error
refuses() {
    expected=$1
    shift
    begin "refuses: meniscus $*"
    small_scene
    run "$@"
    exits 2
    empty out
    says err "$expected"
    end
}

begin "no arguments: a summary, status 2"
run
exits 2
says err "usage: meniscus COMMAND"
end

refuses "unknown command 'rendr'; did you mean 'render'?" rendr small.mns
refuses "unknown command 'xyzzy'" xyzzy
refuses "unknown option '--sp'; did you mean '--spp'?" render --sp 3 small.mns
refuses "unknown option '--bogus'" small.mns --bogus
refuses "unknown option '--level'; a parameter of the scene is set by '-D level=...'" small.mns --level 9
refuses "unknown option '--time'; did you mean '--time-limit'?" render --time 10s small.mns
refuses "unknown option '--sample'; here it is --spp 32" render --sample 10 small.mns
refuses "unknown option '--s'" render --s 10 small.mns
refuses "unknown option '-Z'" render -Z small.mns
refuses "unknown option '-Z' in '-qZ'" render -qZ small.mns
refuses "did you mean '--spp' (with two dashes)?" render -spp 3 small.mns
refuses "'render' has no option '--flip'; 'compare' has one" render --flip small.mns
refuses "'render' needs SCENE: a file, or - for standard input" render
refuses "'other.mns' is one word too many" render small.mns other.mns
refuses "'small.png' is one word too many: what is written stands behind -o, as -o small.png" render small.mns small.png
refuses "'albedo' is one word too many: '--aov' takes one, LIST, as in: meniscus render glass.mns --aov normal,depth" render --aov depth albedo small.mns
refuses "'min' is one word too many: '--time-limit' takes one, TIME" small.mns --time-limit 10 min
refuses "'b=2' is one word too many: each NAME=VALUE has its own '-D', as -D b=2" small.mns -D a=1 b=2
refuses "'s.json' is one word too many: the file of '--stats' stands behind '=', as --stats=s.json" small.mns --stats s.json
refuses "'small.mns' is one word too many: 'render' takes SCENE" -s 3 other.mns small.mns
refuses "option '--scale': 50 is outside of 0.0001 to 10; hundredths have a '%', as 50%" small.mns --scale 50
refuses "'+W640' is POV-Ray's; here it is --size 640x480" render small.mns +W640 +H480
refuses "'+P' is POV-Ray's; here it is --preview term" render small.mns +P +D
refuses "'+SC0.2' is POV-Ray's; here it is --crop 10,20,110,120" render small.mns +SC0.2 +EC0.4
refuses "'+SF3' is POV-Ray's; here it is --frames 10..20" render small.mns +SF3
refuses "'+C' is POV-Ray's; here it is --skip-existing" render small.mns +C
refuses "'+WT4' is POV-Ray's; here it is -j 4" render small.mns +WT4
refuses "unknown option '-W'; here it is --size 640x480" render small.mns -W 640
refuses "unknown option '--width'; here it is --size 640x480" render small.mns --width 640
refuses "unknown option '-H480'; here it is --size 640x480" render small.mns -H480
refuses "unknown option '--quality'; here it is -s 32" render small.mns --quality 9
refuses "unknown option '--samples'; here it is --spp 32" render small.mns --samples 32
refuses "unknown option '-samples'; here it is --spp 32" render small.mns -samples 32
refuses "unknown option '--out'; here it is --output picture.exr" render small.mns --out a.exr
refuses "unknown option '--out'" check small.mns --out a.exr
refuses "unknown option '-Y'" render small.mns -Y
refuses "option '--spp' needs a value" render small.mns --spp
refuses "option '--half' takes no value" render small.mns --half=yes
refuses "'0' is not a whole number from 1 to 16777216" render small.mns --spp 0
refuses "'-3' is not a whole number" render small.mns -s -3
refuses "'1e3' is not a whole number" render small.mns -s 1e3
refuses "the width of 0x10 is outside of 1 to 65536" render small.mns --size 0x10
refuses "the height of 10x65537 is outside" render small.mns --size 10x65537
refuses "'640' is not a width and a height" render small.mns --size 640
refuses "'10x' is not a time" render small.mns -t 10x
refuses "'0s' is not a time" render small.mns -t 0s
refuses "is not four whole numbers" render small.mns --crop 1,2,3
refuses "or percent up to 100" render small.mns --crop 10%,0,101%,8
refuses "or percent up to 100" render small.mns --crop 0.3,0.1,0.6,0.5
refuses "or percent up to 100" render small.mns --crop -5%,0%,50%,50%
refuses "holds no pixel" render small.mns --crop 4,0,4,8
refuses "holds no pixel" render small.mns --crop 50%,0,50%,8
refuses "8,0,8,8 of the picture of 16 x 16 holds no pixel" render small.mns --crop 8,0,50%,50%
refuses "16,17 is outside of the picture of 16 x 16" render small.mns --crop 0,0,16,17
refuses "'level' is not NAME=VALUE, as level=true is" render small.mns -D level
refuses "did you mean 'automatic'?" render small.mns --nesting automtic
refuses "option '--aov': there is no 'nrmal'; did you mean 'normal'?" render small.mns --aov depth,nrmal
refuses "option '--aov': there is no 'object_id'; did you mean 'object'?" render small.mns --aov object_id
refuses "option '--aov': there is no 'motion'; leave it out: motion is no layer" render small.mns --aov motion,depth
refuses "option '--aov': there is no 'banana'; there are albedo, normal, depth" render small.mns --aov banana
refuses "150% is outside of 0 to 1" render small.mns --noise 150%
refuses "must end in .exr or .png" render small.mns -o small.jpg
refuses "output '.exr' has no name in front of its ending, as picture.exr does" render small.mns -o .exr
refuses "output './.PNG' has no name in front of its ending" check small.mns --slice y=1 --slice-output ./.PNG
refuses "'1,2,3' is a point: write its plane's normal behind it, as 1,2,3:0,1,0" check small.mns --slice 1,2,3
refuses "there is no help for 'banana split'" help banana split
refuses "'sphere' is one word too many: with '--json' help gives all that there is" help --json sphere
refuses "standard input has no place to write to: leave '--in-place' out" fmt -i small.mns -
refuses "is named twice" render small.mns -o a.exr -o a.exr
refuses "option '-o': the value is empty" render small.mns -o ''
refuses "display 'nowhere'" render small.mns -o a.png --display nowhere
refuses "there is no completion for 'tcsh'" completion tcsh
run help "Newton's Rings"
exits 0
says out "no etalons"
run help hdri
exits 0
says out 'environment { image = "studio.exr" }'
for topic in polarizer polarisation; do
    run help $topic
    exits 0
    says out 'There is no filter that polarizes'
done
run help thin_film
exits 0
says out 'film = 400nm'
run help frosted_glass
exits 0
says out "surface { roughness = .3 }"
for topic in platinum rose_gold white_gold bronze; do
    run help $topic
    exits 0
    says out 'surface { metal = platinum'
done
while read -r topic answer; do
    run help "$topic"
    exits 0
    says out "$answer"
done <<'TOPICS'
smoked tint = rgb(
condensation shapes.droplets(
dew shapes.droplets(
fire emission = blackbody(
engraving difference {
cracks interior = air
frost roughness = .3
glazing thin = true
low-e metal = silver
reeded_glass curve = natural
total_reflection --ray
critical_angle mirrored totally
brewster_angle unpolarized
newtons_rings no etalons
layered_liquids glassware.pour(
exit_status 75: the picture is not finished
fractals A macro may call itself
tilt-shift no tilt of the lens
immersion_oil same index
backlit studio.dark_field
glass_block isosurface {
neon lights.illuminant_f2()
dusk sky = clear
snow phase = hg(.85)
tiles bond = 0
pool function = waves
milk use "std/media.mns" as media
sun_position lights.daylight_at(
mirage media.air_at(
pearl film = 420nm
opal scatters
amber ior = 1.54
marquise gems.faceted(
slow --denoise on
ctrl-c --resume
crema media.foam(
prongs gems.faceted(
concave_mirror optics.mirror
float tint = rgb(
staircase media.pvb
white_background studio.cutout_shot(
aberration --ray
gold-foil transmission = 0
anti-reflective film_ior = 1.33
brushed-steel anisotropy = .8
gradient-softbox emission = gradient
sunbeams phase = hg(.8)
lume not computed
cat's-eye anisotropy = .95
waterline expect = [water]
icicles curve = cubic
makefile check drink.mns --files
stdin -o drink.exr
media.acrylic Acrylic glass, PMMA
wine_glass use "std/glassware.mns" as glassware
scatter Places what stands behind it n times on a disc
TOPICS
for topic in 'transparent background' transparent_background transparent-background; do
    run help "$topic"
    exits 0
    says out '--alpha on'
done
run help double glazing
exits 0
run help ' double  glazing '
exits 0
says out 'double glazing, as each of its sides is one'
run help subjects
exits 0
says out 'alpha, antialiasing,'
run help mist
exits 0
says out 'bows, coronas and glories of their size'
run help fogbow
exits 0
says out 'phase = droplets(20)'
refuses "a distant light and drops before it make one" help rainbow
refuses "there is no help for 'opn-mesh'; did you mean 'open-mesh'?" help opn-mesh
refuses "there is no help for 'roughnes'; did you mean 'roughness'?" help roughnes
refuses "'light_source' is POV-Ray's, see meniscus-povray(7); write: light {" help light_source
refuses "there is no help for 'smothstep'; did you mean 'smoothstep'?" help smothstep
refuses "there is no help for 'exposur'; did you mean 'exposure'?" help exposur
refuses "there is no help for 'parma'; did you mean 'param'?" help parma
refuses "'macro' is POV-Ray's, see meniscus-povray(7); write: def NAME { ... }" help macro
refuses "there is no help for 'look_at'; in a camera, write: to = ..." help look_at
refuses "there is no help for 'focal_length'; in a camera, write: fov = 40" help focal length
refuses "there is no help for 'shutter_speed'; in a camera, write: shutter = 180" help 'shutter speed'
refuses "aperture = 50mm / 2.8" help f-stop
refuses "aperture = 50mm / 2.8" help f-number
refuses "there is no help for 'rough ice' as one thing, but for 'ice'" help rough ice
refuses "as one thing, but for 'gold' and 'watch'" help gold watch
refuses "there is no help for 'cubic_spline'; in a lathe, write: curve = cubic" help cubic_spline
refuses "there is no help for 'principled'; write: surface = surface { albedo" help principled
refuses "there is no help for 'rand'; write: rnd(seed, i), which has no state" help rand
refuses "'help' has no option '--exposure'; 'meniscus help exposure' explains it" help --exposure
refuses "'Declare=N=3' is POV-Ray's; here it is -D NAME=VALUE" render small.mns Declare=N=3
refuses "unknown option '-w'; here it is --size 640x480" render small.mns -w 640
refuses "unknown option '--max-depth'; here it is --set render.bounces=32" render small.mns --max-depth 8
refuses "unknown option '--start-frame'; here it is --frames 10..20" render small.mns --start-frame 8
refuses "unknown option '-f'; here it is --frames 12" render small.mns -f 12
refuses "unknown option '--depfile'; here it is meniscus check SCENE --files" render small.mns --depfile
refuses "unknown option '--video'; here it is --frames all" render small.mns --video
refuses "unknown option '--dry-run'; here it is meniscus check SCENE" render small.mns --dry-run
refuses "unknown option '-M'; here it is meniscus check SCENE --files" render small.mns -M
refuses "there is no 'Z'; did you mean 'depth'?" render small.mns --aov Z
refuses "unknown option '--json'; here it is --progress json, --log-format json" render small.mns --json
refuses "'sphere' has no property 'centre'; write: center = ..." help sphere.centre
refuses "'sphere' has no property 'raduis'; did you mean 'radius'?" help sphere.raduis
refuses "'film' has no property 'gamma'; leave it out: an EXR file keeps light as it is" help film.gamma
refuses "'lathe' has no property 'wobble'; 'meniscus help lathe' lists those that it has" help lathe.wobble
refuses "there is no help for 'window-frames', only for commands, their options, nodes" help window-frames
refuses "1..10 of a scene that is no animation; --set animation.frames=10 makes it one" render small.mns --frames 1..10
refuses "to render 'small.mns', write its whole name" small
refuses "'small.mns' is a scene; 'meniscus check small.mns' says what it holds" info small.mns
refuses "the display 'sRGB' has no view 'film'; there is 'ACES 1.0 SDR'" small.mns -o a.png --view film

begin "a file without dot or slash: a hint"
small_scene
cp small.mns scene
run scene
exits 2
says err "meniscus render scene"
end

begin "the shorthand renders"
small_scene
run ./small.mns -o a.exr
exits 0
there a.exr
end

begin "options before the scene, too"
small_scene
run -s 1 small.mns -o a.exr
exits 0
there a.exr
end

begin "clusters, joined and separate values, --name=value, last one wins"
small_scene
run render -qs2 -j 1 --spp=3 --size 99x99 --size=8x8 -oa.exr small.mns
exits 0
empty err
run info a.exr
matches out 'meniscus/samples +3$'
matches out 'dataWindow.*7'
end

begin "-- ends the options"
small_scene
cp small.mns ./-small.mns
run render -o a.exr -- -small.mns
exits 0
there a.exr
end

begin "help goes to standard output, status 0"
for command in render check params view compare info bench completion help version; do
    run $command -h
    exits 0
    says out "usage: meniscus $command"
    [ "$(grep -c '^  meniscus ' out)" -ge 1 ] || flunk "$command -h has no example"
    run $command --help
    exits 0
    says out "Manual: meniscus-$command(1)"
    empty err
done
run -h
exits 0
run --version
exits 0
matches out '^meniscus [0-9]+\.[0-9]+'
run help cylinder
says out radius
for topic in 'double glazing:a thin surface' 'camera fov:a property of camera' 'open mesh:open-mesh' 'std glassware:std/glassware.mns'; do
    run help ${topic%%:*} # several words
    exits 0
    says out "${topic#*:}"
done
run help smoothstep
says out "smoothstep(a, b, x): 0 up to a"
run help noise
says out "octaves"
says out "As a function:"
says out "As a property:"
says out "As an option of render:"
run help exposure
matches out '^As an option of render, merge and view:$'
matches out '^      --exposure STOPS$'
run help quiet
matches out '^As an option of render.* and .*:$'
run help thin
says out "it has no inside"
run help for
exits 0
says out "for is a word of the scene language:"
says out "meniscus-language(5)"
run help param
says out "param level = 34mm in 5mm..60mm"
run help x
says out "x, y and z are the axes"
run help frames
matches out '^In the language:$'
run help ior
says out "  medium
      index of refraction: a number"
says out "  surface
      index of refraction of a clear skin"
run help surface
matches out '^  diffuse_roughness$'
matches out '\(an image\)$'
run help lathe.profile
exits 0
says out "profile - a property of lathe"
says out "the corners <radius, height>"
for subject in loop focal_blur dof antialiasing fresnel gamma overlap; do
    run help "$subject"
    exits 0
    says out "Manual: meniscus-"
done
run help hsv
says out "hsv(hue, saturation, value)"
run help cauchy
says out "a refractive index"
for topic in povray language scene errors loops; do
    run help $topic
    exits 0
    matches out '^Manual: meniscus'
done
run help languag
exits 2
says err "did you mean 'language'?"
run help open-mesh
says out interior
end

begin "help that cannot be written: status 5"
"$program" help render > /dev/full 2> err
status=$?
exits 5
says err "cannot write to standard output"
end
