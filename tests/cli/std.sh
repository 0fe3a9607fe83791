# std.sh - the standard library: found, explained, and right in any unit.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# Everything that the library places, once, and every function.
std_scene() {
cat > all.mns << SCENE
meniscus 1.0 unit $1
use "std/gems.mns" as gems
use "std/glassware.mns" as glassware
use "std/lights.mns" as lights
use "std/media.mns" as media
use "std/optics.mns" as optics
use "std/shapes.mns" as shapes
use "std/studio.mns" as studio
group { glassware.tumbler { drink = media.whisky }  translate(<-5 * 30cm, 0, 0>) }
group { glassware.highball { drink = media.cola }  translate(<-4 * 30cm, 0, 0>) }
group { glassware.shot_glass { drink = media.ethanol }  translate(<-3 * 30cm, 0, 0>) }
group { glassware.wine_glass { drink = media.red_wine }  translate(<-2 * 30cm, 0, 0>) }
group { glassware.champagne_flute { drink = media.white_wine }  translate(<-1 * 30cm, 0, 0>) }
group { glassware.cocktail_glass { drink = media.curacao } }
group { glassware.coupe { drink = media.white_wine }  translate(<1 * 30cm, 0, 0>) }
group { glassware.beer_mug { drink = media.beer }  translate(<2 * 30cm, 0, 0>) }
group { glassware.carafe { drink = media.water }  translate(<3 * 30cm, 0, 0>) }
group { glassware.bottle { drink = media.olive_oil }  translate(<4 * 30cm, 0, 0>) }
group { glassware.bowl { drink = media.tea }  translate(<5 * 30cm, 0, 0>) }
group { glassware.vase { drink = media.pond_water  interior = media.lead_crystal }  translate(<6 * 30cm, 0, 0>) }
group { glassware.beaker { drink = media.honey }  translate(<7 * 30cm, 0, 0>) }
group { glassware.flask { drink = media.glycerol }  translate(<8 * 30cm, 0, 0>) }
group { glassware.test_tube { drink = media.coffee }  translate(<9 * 30cm, 0, 0>) }
let inside = shapes.round_corners([<0, 5mm, 0>, <30mm, 5mm, 4mm>, <30mm, 50mm, 0>])
group {
  glassware.vessel([<0, 0, 0>, <34mm, 0, 2mm>, <34mm, 50mm, 0>], inside)
  glassware.pour(inside, 30mm, media.water)
  translate(<10 * 30cm, 0, 0>)
}
group {
  glassware.vessel { outside = [<0, 0>, <34mm, 0>, <34mm, 50mm>]  inside = [<0, 5mm>, <30mm, 5mm, 4mm>, <30mm, 50mm>]
                     surface = surface { roughness = .3 }  drink = media.water  level = 30mm }
  translate(<12 * 30cm, 0, 0>)
}
group { glassware.stemware([for (p in shapes.offset(inside, 1mm)) p + <0, 80mm>])  translate(<11 * 30cm, 0, 0>) }
assert(abs(glassware.radius_at(inside, 40mm) - 30mm) < 1e-6mm and glassware.radius_at(inside, 60mm) == 0)
group { gems.round_brilliant()  translate(<-5 * 30cm, 2cm, 40cm>) }
group { gems.rose()  translate(<-4 * 30cm, 2cm, 40cm>) }
group { gems.cabochon()  translate(<-3 * 30cm, 2cm, 40cm>) }
group { gems.emerald_cut()  translate(<-2 * 30cm, 2cm, 40cm>) }
group { gems.princess()  translate(<-1 * 30cm, 2cm, 40cm>) }
group { gems.faceted([[90, 1, [0, 24, 48, 72]], [45, .92, [0, 24, 48, 72]], [0, .6], [0, -.2]])  translate(<0, 2cm, 80cm>) }
group { shapes.bubbles(5)  translate(<0, 0, 40cm>) }
group { shapes.bubble_chain(5)  translate(<1 * 30cm, 0, 40cm>) }
group { shapes.drop { interior = media.water }  translate(<2 * 30cm, 0, 40cm>) }
group { shapes.droplets { n = 5  interior = media.water }  translate(<3 * 30cm, 0, 40cm>) }
let glass = group { glassware.tumbler() }
group { glass { }  glassware.dew { on = glass  n = 5 }  translate(<-1 * 30cm, 0, 120cm>) }
group { shapes.ice_cube { interior = media.ice  bubbles = 5 }  translate(<4 * 30cm, 0, 40cm>) }
group { shapes.rod { path = [for (a in 0..90 by 5) 40mm * <cos(a), sin(a), 0>]  interior = media.acrylic }  translate(<5 * 30cm, 0, 40cm>) }
shapes.sheet { width = 20mm  height = 30mm  surface = surface { thin = true  transmission = 1  ior = 1.5 } }
let sheet = bounds(group { shapes.sheet(20mm, 30mm) })
assert(distance(sheet.min, <-10mm, 0, 0>) + distance(sheet.max, <10mm, 30mm, 0>) < .001mm)
assert(hit(group { shapes.sheet(20mm, 30mm) }, <0, 9mm, -9mm>, z).normal.z > .99, "its front is at +z")
assert(len(shapes.path_frames([x, y], z)) == 2 and length(shapes.disc_point(1, 2, 3mm)) <= 3mm)
assert(len(shapes.hold_edges([<0, 0>, <9, 0>, <9, 1>], 1)) == 5)
assert(len(shapes.hold_edges([for (a in 0..90 by 5) 100 * <cos(a), sin(a)>, <0, 200>], 1)) == 24)  // held: the ends alone
group { optics.lens()  translate(<-5 * 30cm, 0, 120cm>) }
group { optics.lens { front = none  back = -40mm }  translate(<-4 * 30cm, 0, 120cm>) }
group { optics.fresnel_lens()  translate(<-3 * 30cm, 0, 120cm>) }
group { optics.corner_cube()  translate(<-2 * 30cm, 0, 120cm>) }
group { optics.mirror()  translate(<-1 * 30cm, 0, 120cm + 40cm>) }
group { optics.mirror { radius = -150mm }  translate(<0, 0, 120cm + 40cm>) }
group { optics.mirror { radius = none }  translate(<1 * 30cm, 0, 120cm + 40cm>) }
group { optics.parabolic_mirror()  translate(<2 * 30cm, 0, 120cm + 40cm>) }
group { optics.parabolic_mirror { focus = -100mm  hole = 20mm }  translate(<3 * 30cm, 0, 120cm + 40cm>) }
group { optics.elliptic_mirror()  translate(<4 * 30cm, 0, 120cm + 40cm>) }
assert(optics.mirror_focus(radius = -150mm) == -75mm)
assert(lights.sun_at(0, 0, 3, 20, 12).x > 87)
assert(abs(optics.lens_focus(front = none, back = 50mm, n = 1.5) - 100mm) < 1e-6mm)
let ball = sphere { radius = 2mm  interior = media.borosilicate }
sphere { radius = 2mm  interior = media.foam()  center = <10 * 30cm, 0, 40cm> }
group { shapes.ring(4, 20mm) { ball { } }  translate(<6 * 30cm, 0, 40cm>) }
group { shapes.row(4, 20mm * z) { ball { } }  translate(<7 * 30cm, 0, 40cm>) }
group { shapes.grid(2, 2, <20mm, 0, 20mm>) { ball { } }  translate(<8 * 30cm, 0, 40cm>) }
group { shapes.scatter(3, 90mm, 4) { ball { } }  translate(<9 * 30cm, 0, 40cm>) }
studio.sweep()
group { studio.table()  translate(<0, -1m, 2m>) }
studio.light_tent()
studio.product_lights()
studio.product_camera()
studio.top_camera()
studio.hero_camera()
lights.softbox()
lights.strip { power = 3  color = lights.tungsten() }
lights.softbox { from = <-700mm, 700mm, 500mm>  angle = 30 }
lights.laser { wavelength = 633 }
lights.laser { from = <-600mm, 220mm, 0>  wavelength = 650nm }
lights.window()
lights.lamp { color = lights.candle_light() }
lights.lamp { at = <100mm, 900mm, 0>  color = lights.illuminant_a()  power = 2 }
lights.sparkle { n = 2  color = lights.sodium() }
lights.three_point { color = lights.sunlight() }
lights.lamp { at = <200mm, 900mm, 0>  color = lights.skylight() }
let colors = [lights.illuminant_d(5000K), lights.illuminant_d50(), lights.illuminant_d55(), lights.illuminant_d65(),
  lights.illuminant_e(), lights.illuminant_f2(), lights.illuminant_f7(), lights.illuminant_f11(), lights.illuminant_led_b3()]
for (i in 0..<len(colors)) { lights.lamp { at = <i * 100mm, 1200mm, 0>  color = colors[i] } }
lights.sun()
param around = "sky" in ["sky", "clouds", "room", "place"]
if (around == "place") { lights.daylight_at(52.5, 13.4, 6, 21, 13, zone = 2) } else if (around == "clouds") { lights.overcast() } else if (around == "room") { studio.room { light = .5  rotate(y, 30) } } else { lights.daylight() }
SCENE
}

begin "std: all of it makes closed hulls, without a warning, of the same size in every unit"
for unit in mm cm m; do
    std_scene $unit
    run check all.mns --werror
    exits 0
    no_complaint err
    sed -n '/^Clear/,$p' out > "report.$unit"
done
for around in clouds room place; do
    run check all.mns -D around=$around --werror
    exits 0
done
says report.mm drink
cmp -s report.mm report.cm || flunk "$(diff report.mm report.cm)"
cmp -s report.mm report.m || flunk "$(diff report.mm report.m)"
end

begin "std: nothing that it offers is missing from that scene, but whole set-ups"
std_scene mm
for file in "$root"/src/std/*.mns; do
    for entry in $(sed -n 's/^def \([a-z][a-z0-9_]*\)(.*/\1/p' "$file"); do
        case $entry in product_shot|tent_shot|cutout_shot|dark_field|gem_shot|face_up|abbe|gem_ior|air_at) continue ;; esac
        grep -q "\\.$entry\\b" all.mns || flunk "$file: $entry is not tried"
    done
done
end

begin "std: paper of a product_shot comes out about as bright as it is"
for paper in .3 .6 .85; do
    cat > paper.mns << SCENE
meniscus 1.0 unit mm
use "std/studio.mns" as studio
studio.product_shot(100mm, paper = rgb($paper)) { sphere { radius = .1mm  center = <0, 40mm, 0>  surface = surface { } } }
film { size = <12, 9> }
SCENE
    run render paper.mns -s 64 -q -o paper.exr
    exits 0
    run compare paper.exr paper.exr
    mean=$(awk '/^mean of A/ { print $5 }' out)
    awk "BEGIN { exit !($mean > .88 * $paper && $mean < 1.12 * $paper) }" || flunk "paper of $paper is $mean"
done
end

begin "std: whole set-ups in five lines"
for shot in product_shot tent_shot cutout_shot dark_field gem_shot face_up; do
    cat > shot.mns << SCENE
meniscus 1.0 unit cm
use "std/gems.mns" as gems
use "std/studio.mns" as studio
studio.$shot(1cm) { gems.round_brilliant { translate(.5cm * y) } }
film { size = <8, 8> }
SCENE
    run check shot.mns --werror
    exits 0
    run render shot.mns -s 2
    exits 0
done
end

begin "std: in a dark field a drink has its colour at its edges, and is dark in its middle, from all sides"
for view in "" ", azimuth = 50" ", elevation = 0"; do
    cat > drink.mns << SCENE
meniscus 1.0 unit mm
use "std/media.mns" as media
use "std/glassware.mns" as glassware
use "std/studio.mns" as studio
studio.dark_field(100mm$view) { glassware.tumbler { drink = media.whisky  level = 55mm } }
film { size = <50, 50> }
render { samples = 64 }
SCENE
    run render drink.mns --pixel 14,28
    exits 0
    awk '$1 == "R" && $2 > .3 { r = 1 } $1 == "B" && $2 < .05 { b = 1 } END { exit !(r && b) }' out || flunk "no amber:$view"
    run render drink.mns --pixel 25,3
    awk '/^[RGB] / && $2 > .02 { exit 1 }' out || flunk "the card does not fill the picture:$view"
done
end

begin "std: foam turns light after as many bubbles as were measured; milk is white"
cat > white.mns << 'SCENE'
meniscus 1.0 unit mm
use "std/media.mns" as media
param what = 0
box { interior = what == 0 ? media.milk : what == 1 ? media.skimmed_milk : media.foam(1mm, .14)
      from = <-90, -90, -90>  to = <90, 90, 0> }
environment { color = 1 }
camera { from = <0, 0, 300>  to = <0, 0, 0>  fov = 2 }
film { size = <2, 2> }
render { samples = 256 }
SCENE
run dump white.mns -D what=2
says out "absorption = 0  scattering = 0.4  state = liquid"
run render white.mns --pixel 0,0
exits 0
# of light from all sides, what a half-space without a boundary gives back: some .9 of red, and most of blue
awk '$1 == "R" { r = $2 } $1 == "B" { b = $2 } END { exit !(r > .85 && r < 1 && b > .75 && b < r) }' out || flunk "milk is not white"
end

begin "std: no ray loses its place in a glass, full or empty"
for glass in tumbler wine_glass cocktail_glass champagne_flute beer_mug bottle beaker test_tube; do
    cat > glass.mns << SCENE
meniscus 1.0 unit mm
use "std/glassware.mns" as glassware
medium liquid { ior = 1.2  state = liquid }
medium solid { ior = 1.3  state = solid }
glassware.$glass { drink = liquid  interior = solid }
environment { }
camera { from = <120, 350, 600>  to = <0, 90, 0>  fov = 22 }
film { size = <60, 80> }
SCENE
    run render glass.mns -s 24
    exits 0
    says err ", 0 nesting faults"
done
end

begin "std: every glass can be filled to any level between its lowest point and its rim"
# the lowest point inside of each, and the rim
set -- tumbler 11 92 highball 12 150 shot_glass 14 60 wine_glass 107 215 champagne_flute 80 230 cocktail_glass 107.649 172 \
    coupe 98 148 beer_mug 13 125 carafe 6 240 bottle 6.6 300 bowl 9 85 vase 16 220 beaker 2 92 flask 2 130 test_tube 1 150
{
    printf 'meniscus 1.0 unit mm\nuse "std/glassware.mns" as g\nuse "std/media.mns" as m\n'
    printf 'let parts = [.003, for (k in 1..59) k / 60, .9999]\n'
    printf 'camera { from = <0, 0, 9000>  to = <0, 0, 0> }\nenvironment { }\n'
    i=0
    while [ $# -gt 0 ]; do
        printf 'for (k in 0..60) { group { g.%s { drink = m.water  level = mix(%smm, %smm, parts[k]) } ' "$1" "$2" "$3"
        printf 'translate(<250mm * (k %% 8 - 4), 400mm * (%d - 7), 250mm * (floor(k / 8) - 4)>) } }\n' "$i"
        i=$((i + 1))
        shift 3
    done
} > levels.mns
run check levels.mns --werror
exits 0
no_complaint err
matches out '915 ×  drink '
says_not out inside
printf 'meniscus 1.0 unit cm\nuse "std/glassware.mns" as g\nuse "std/media.mns" as m\ng.%s { drink = m.water  level = %s }\n' \
    cocktail_glass 107.6mm > low.mns
run check low.mns
exits 3
says err "error: the level of 107.6 mm is not between the floor at 107.7 mm and the rim at 172 mm"
printf 'meniscus 1.0 unit cm\nuse "std/glassware.mns" as g\nuse "std/media.mns" as m\ng.%s { drink = m.water  level = %s }\n' \
    vase 22 > brim.mns
run check brim.mns
exits 3
says err "error: the level of 220 mm is not between the floor at 16 mm and the rim at 220 mm"
printf 'meniscus 1.0 unit cm\nuse "std/glassware.mns" as g\n%s\n' \
    'g.vessel { outside = [<.45, 2>, <4, 10>, <4, 20>]  inside = [<0, 2>, <3.8, 10>, <3.8, 20>] }' > floor.mns
run check floor.mns
exits 3
says err "floor.mns:3:1: error: the floor inside, at 20 mm, is not above the middle of the foot, at 20 mm"
end

begin "std: a drink is as much as its level says, in a shallow bowl and around a punt"
cat > measured.mns << 'SCENE'
meniscus 1.0 unit mm
use "std/glassware.mns" as g
use "std/media.mns" as m
// a cone without a meniscus, one with it, and a ring around a cone
let bowl = [<0, 0>, <100, 20>]
let punt = [<0, 30>, <20, 0>, <40, 0>, <40, 60>]
group { g.pour(bowl, 10, m.water, 0, 0) }
group { g.pour(bowl, 10, m.water, 0)  translate(300 * x) }
group { g.pour(punt, 15, m.water, 0, 0)  translate(600 * x) }
group { g.pour(punt, 15, m.water, 0)  translate(900 * x) }
camera { from = <0, 0, 9000>  to = <0, 0, 0> }
environment { }
SCENE
run check measured.mns --werror
exits 0
matches out 'drink  *water  *26\.2 cm³'     # pi / 3 * 50² * 10
matches out 'drink 2  *water  *26\.[2-4] cm³'
matches out 'drink 3  *water  *64\.4 cm³'   # pi * (40² * 15 - (20² + 20 * 10 + 10²) / 3 * 15)
matches out 'drink 4  *water  *6[45]\.[0-9] cm³'
end

begin "std: the texts are laid out, and every entry is explained"
for file in "$root"/src/std/*.mns; do
    run fmt --check "$file"
    exits 0
    topic=std/$(basename "$file" .mns)
    run help "$topic"
    exits 0
    says out "use \"$topic.mns\" as"
    run help "$topic.mns"
    cmp -s out "$file" || flunk "$topic.mns is not printed as it is"
    undocumented=$(awk '/^(def|let|medium) [a-z]/ && last !~ /^\/\// { print FILENAME ": " $0 } { last = $0 }' "$file")
    [ -z "$undocumented" ] || flunk "$undocumented"
done
run help std
exits 0
says out std/media.mns
run help glassware
exits 0
says out 'std/glassware.mns - '
run help glasswar
exits 2
says err "did you mean 'std/glassware.mns'?"
run help glas
exits 2
says_not err "did you mean"
run help bubblse
exits 2
says err "did you mean 'bubbles'?"
run help std/glasware
exits 2
says err "did you mean 'std/glassware.mns'?"
end

begin "std: a file of the scene's own comes first; the library's own parts do not change"
mkdir -p std
printf 'meniscus 1.0\ndef n() = 7\n' > std/media.mns
printf 'meniscus 1.0 unit mm\nuse "std/media.mns" as m\nuse "std/gems.mns" as gems\nprint(m.n())\ngems.round_brilliant()\ncamera { from = 50 * z }\nenvironment { }\n' > own.mns
run check own.mns
exits 0
says err 7
says out diamond
end

begin "std: confinement and standard input leave it as it is"
small_scene
printf 'meniscus 1.0 unit mm\nuse "std/gems.mns" as gems\ngems.rose()\ncamera { from = 50 * z }\nenvironment { }\n' > a.mns

run check a.mns --confine .
exits 0
"$program" check - < a.mns > out 2> err
status=$?
exits 0
says out garnet
end

begin "std: what is not there, and mistakes within, are shown with their lines"
printf 'meniscus 1.0 unit mm\nuse "std/glaswares.mns" as g\nuse "std/nothing.mns" as n\n' > wrong.mns
run check wrong.mns
exits 3
says err "no file 'std/glaswares.mns'"
says err "did you mean 'std/glassware.mns'?"
says err "meniscus help std lists what the library has"
printf 'meniscus 1.0 unit mm\nuse "std/glassware.mns" as g\nuse "std/media.mns" as m\ng.tumbler { drink = m.water  level = 500mm }\n' > high.mns
run check high.mns
exits 3
matches err '^high\.mns:4:1: error: the level of 500 mm is not between the floor at 11 mm and the rim at 92 mm'
matches err '^std/glassware\.mns:[0-9]+:[0-9]+: note: met here, in the standard library'
says err "called from high.mns:4"
end

begin "std: without its layout, laid out again, and dumped flat it means the same"
std_scene mm
same_flat all.mns
mkdir std # what stands there goes before what is built in, but for the library's own parts
cp "$root"/src/std/*.mns std
hash=$(scene_hash all.mns)
for file in "$root"/src/std/*.mns; do
    sed -e 's/^[ 	]*//' -e 's/  */ /g' "$file" > "std/$(basename "$file")"
done
[ "$(scene_hash all.mns)" = "$hash" ] || flunk "the hash is another one without the layout"
run fmt -i std/*.mns
exits 0
run fmt --check std/*.mns
exits 0
[ "$(scene_hash all.mns)" = "$hash" ] || flunk "the hash is another one when it is laid out again"
end

begin "std: a glass in the form of a node, and a drink made by hand that reaches into its wall"
cat > soda.mns <<'SCENE'
meniscus 1.0 unit mm
use "std/glassware.mns" as gw
medium glass { ior = 1.50  state = solid }
medium soda  { ior = 1.333  tint = rgb(.96, .90, .78)  depth = 60mm  state = liquid }
gw.tumbler { radius = 33  height = 130  wall = 2.4  base = 11  interior = glass }
cylinder drink { interior = soda  from = <0, 10.9, 0>  to = <0, 118, 0>  radius = 33.1 }
camera { from = <0, 150, 330>  to = <0, 62, 0>  fov = 26deg }
environment { }
SCENE
run check soda.mns --werror
exits 0
matches out 'vessel overlaps drink by .*: vessel on top, by state of matter'
end

begin "std: the wall around an inside that ends on the axis ends there, too"
cat > bulb.mns <<'SCENE'
meniscus 1.0 unit mm
use "std/shapes.mns" as shapes
use "std/media.mns" as media
let inside = [<0, 12>, <18, 13>, <24, 22>, <12, 50>, <1.6, 60>, <12, 70>, <24, 98>, <18, 107>, <0, 108>]
let around = shapes.offset(inside, 1.6)
assert(distance(around[0], <0, 10.4>) < 1e-12 and distance(around[len(around) - 1], <0, 109.6>) < 1e-12, around)
lathe bulb { interior = media.clear_glass  curve = cubic  profile = around }
lathe hollow { interior = air  curve = cubic  profile = inside }
camera { from = <0, 150, 330>  to = <0, 62, 0>  fov = 26deg }
environment { }
SCENE
run check bulb.mns --werror
exits 0
says out "hollow inside bulb: hollow on top, by containment"
end

begin "std: dew is on the outside of a glass, up to its height, and no air is below it"
for glass in "tumbler { flare = 6mm  drink = media.water }" "wine_glass { drink = media.red_wine }" "vase { drink = media.water }"; do
    cat > dew.mns << SCENE
meniscus 1.0 unit mm
use "std/glassware.mns" as glassware
use "std/media.mns" as media
let glass = group { glassware.$glass }
glass { }
let drops = group { glassware.dew { on = glass  n = 40  top = 80mm } }
drops { }
assert(bounds(drops).max.y < 83, "too high")
for (i in 1..200) { let s = scatter(drops, 1, i)  assert(dot(s.point.xz, s.point.xz) > 2, s) }
camera { from = <0, 150, 400>  to = <0, 62, 0> }
environment { }
SCENE
    run check dew.mns --werror
    exits 0
    says_not out "leave a gap"
    says_not out "drink overlaps lathe"
done
end

# The part of a ray's direction across the axis over that along it, of a light that comes up along y at a radius
slope_at() {
    run check bench.mns --ray="$1,-50,0:0,1,0" --ray-least 20% --ray-wavelength 587.6
    exits 0
    sed -n 's/^.*leaves the scene along \([^,]*\), \([^,]*\),.*/\1 \2/p' out | awk '{ print $1 / $2 }'
}

begin "std: lenses of every form have their focal length, and a corner cube sends light back"
for form in "front = 50, back = 50" "front = none, back = 40" "front = -60, back = none" "front = 30, back = -80" "front = -40, back = -40"; do
    cat > bench.mns << SCENE
meniscus 1.0 unit mm
use "std/optics.mns" as optics
print(optics.lens_focus($form, thickness = 7))
optics.lens($form, thickness = 7)
camera { from = <0, 0, 200>  to = <0, 0, 0> }
environment { }
SCENE
    slope=$(slope_at .5)
    awk "BEGIN { f = $(cat err); exit !(sqrt((-.5 / ($slope) / f - 1) ^ 2) < 1e-3) }" || flunk "$form: $slope, not of $(cat err)"
done
cat > bench.mns << 'SCENE'
meniscus 1.0 unit mm
use "std/optics.mns" as optics
optics.fresnel_lens { focus = 100  diameter = 100  rings = 25 }
group { optics.corner_cube()  rotate(x, 180)  translate(<200, 0, 0>) }
camera { from = <0, 0, 400>  to = <0, 0, 0> }
environment { }
SCENE
for middle in 11 25 47; do # of a groove, through which light meets at the focus
    slope=$(slope_at $middle)
    awk "BEGIN { exit !(sqrt((-$middle / ($slope) / 100 - 1) ^ 2) < 2e-3) }" || flunk "at $middle: $slope"
done
run check bench.mns --ray=203,-50,2:.05,1,.1 --ray-least 20%
matches out '  mirrored totally, in n_bk7 '
says out "turned by 180° in all"
end

begin "std: curved mirrors send light where they say, far from the axis, too, and pictures of points are where they should be"
mirror_scene() { # a mirror, and a small target
    cat > mirrors.mns << SCENE
meniscus 1.0 unit mm
use "std/optics.mns" as optics
use "std/media.mns" as media
optics.$1
sphere target { center = <0, $2, 0>  radius = .002  interior = media.water }
camera { from = <0, 0, 900>  to = <0, 0, 0> }
environment { }
SCENE
}
while IFS='|' read -r mirror target ray; do
    mirror_scene "$mirror" "$target"
    run check mirrors.mns --ray="$ray"
    exits 0
    says out "target"
    says out "mirrored"
done << 'ROWS'
mirror(radius = 200)|100|1,300,0:0,-1,0
mirror(radius = 200)|200|0,200,0:.1,-1,.1
parabolic_mirror(focus = 100)|100|15,300,0:0,-1,0
parabolic_mirror(focus = 100, hole = 20)|100|0,300,59:0,-1,0
elliptic_mirror()|240|0,60,0:.1,-1,0
elliptic_mirror()|240|0,60,0:.5,-.6,.1
elliptic_mirror()|60|0,240,0:.2,-1,0
ROWS
mirror_scene "mirror(radius = -200)" 400
run check mirrors.mns --ray 2,300,0:0,-1,0
says out "along 0.019999, 0.9998, 0"
mirror_scene "parabolic_mirror(focus = -100)" 400
run check mirrors.mns --ray 50,300,0:0,-1,0
says out "along 0.47059, 0.88235, 0" # from <0, -100, 0>, by <50, -6.25, 0>
while IFS='|' read -r mirror message; do
    mirror_scene "$mirror" 400
    run check mirrors.mns
    exits 3
    says err "$message"
done << 'ROWS'
mirror(radius = 20)|a mirror of a radius of less than 40, half of its diameter, does not reach its rim
parabolic_mirror(focus = 0)|has a focus that is not 0
parabolic_mirror(hole = 200)|larger than its hole
elliptic_mirror(near = -5)|are above it
elliptic_mirror(near = 5, far = 20)|is only 20 wide
ROWS
end

begin "std: the sun stands where it does, at noon, in the evening and in the south"
cat > sun.mns << 'SCENE'
meniscus 1.0 unit m
use "std/lights.mns" as lights
def near(a, elevation, azimuth) = abs(a.x - elevation) < .03 and abs(a.y - azimuth) < .03
// I. Reda and A. Andreas, Solar Energy 76, 577 (2004): zenith 50.11162, azimuth 194.34024 from north
assert(near(lights.sun_at(39.742476, -105.1786, 10, 17, 12 + 30.5 / 60, zone = -7, year = 2003), 39.88838, 180 - 194.34024), 1)
let sydney = lights.sun_at(-33.87, 151.2, 12, 21, 12, zone = 11)
assert(abs(sydney.y) > 90 and sydney.y > 0 and sydney.x > 75, sydney)  // before noon: north, and a little east
let evening = lights.sun_at(52.5, 13.4, 6, 21, 20, zone = 2)
assert(evening.y < -100 and evening.x > 5 and evening.x < 15, evening)
assert(abs(lights.sun_at(52.5, 13.4, 6, 21, 20, zone = 2, north = 30).y - evening.y - 30) < 1e-9)
assert(lights.sun_at(52.5, 13.4, 2, 29, 0, year = 2024).x == lights.sun_at(52.5, 13.4, 2, 28, 24, year = 2024).x)
sphere { }
camera { from = <0, 0, 9>  to = <0, 0, 0> }
lights.daylight_at(52.5, 13.4, 12, 21, 23)
SCENE
run check sun.mns
exits 3
says err "it is night there: the sun is 60."
end

begin "std: a lens that cannot be says why"
cat > bench.mns << 'SCENE'
meniscus 1.0 unit mm
use "std/optics.mns" as optics
optics.lens { thickness = 2 }
optics.lens { front = 10 }
optics.fresnel_lens { rings = 3 }
SCENE
run check bench.mns
exits 3
says err "it needs a thickness of more than 3.18 mm"
says err "a face of a radius of less than 12.5, half of the diameter, does not reach the rim"
says err "more rings make it less deep"
end
