# textures.sh - pictures on surfaces as a user meets them: files of each kind, colour spaces, damage, what is said of them.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# png NAME WIDTH HEIGHT R G B: a picture of one colour
png() {
    "$python" - "$@" << 'PY'
import struct, sys, zlib
name, width, height, *rgb = sys.argv[1:]
width, height, row = int(width), int(height), bytes(int(c) for c in rgb)
def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
data = zlib.compress((b'\0' + row * width) * height)
open(name, 'wb').write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', width, height, 8, 2, 0, 0, 0))
                       + chunk(b'IDAT', data) + chunk(b'IEND', b''))
PY
}

# ball NAME SURFACE: a scene of one ball
ball() {
    cat > "$1" << SCENE
meniscus 1.0 unit cm
sphere { surface = surface { $2 } }
camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = 30 }
light { from = <3, 5, 4>  to = <0, 0, 0>  size = <2, 2>  radiance = 6 }
environment { color = .5 }
film { size = <32, 32> }
render { samples = 16 }
SCENE
}

begin "a picture of one sRGB colour renders as that colour"
png flat.png 3 5 200 90 40
ball picture.mns 'albedo = image { file = "flat.png" }'
ball colour.mns 'albedo = srgb(200 / 255, 90 / 255, 40 / 255)'
run render picture.mns -o picture.exr
exits 0
run render colour.mns -o colour.exr
exits 0
run compare picture.exr colour.exr --max-rmse 0.003
exits 0
end

begin "raw values, and those that are linear by name, are taken as they are"
png flat.png 3 5 128 128 128
ball raw.mns 'albedo = image { file = "flat.png"  colorspace = "raw" }'
ball named.mns 'albedo = image { file = "flat.png"  colorspace = "lin_rec709" }'
ball grey.mns 'albedo = 128 / 255'
for scene in raw named grey; do
    run render $scene.mns -o $scene.exr
    exits 0
done
run compare raw.exr grey.exr --max-rmse 1e-5
exits 0
run compare named.exr grey.exr --max-rmse 1e-4
exits 0
ball rough.mns 'ior = 1.5  roughness = image { file = "flat.png" }'
ball number.mns 'ior = 1.5  roughness = 128 / 255'
for scene in rough number; do
    run render $scene.mns -o $scene.exr
    exits 0
done
run compare rough.exr number.exr --max-rmse 1e-5
exits 0
end

# label NAME RGB ALPHA: an RGBA picture, clear and black but for a square in the middle, of that grey
label() {
    "$python" - "$@" << 'PY'
import struct, sys, zlib
name, grey, alpha = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
rows = b''.join(b'\0' + b''.join(bytes([grey] * 3 + [alpha]) if 3 <= x < 13 and 3 <= y < 13 else bytes(4) for x in range(16))
                for y in range(16))
open(name, 'wb').write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 16, 16, 8, 6, 0, 0, 0))
                       + chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))
PY
}

begin "what is far away is a mean of the picture, also of one that shines"
"$python" - << 'PY'
import struct, zlib
def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
rows = b''.join(b'\0' + bytes(255 * ((x + y) & 1) for x in range(64)) for y in range(64))
open('checks.png', 'wb').write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 64, 64, 8, 0, 0, 0, 0)) +
                               chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))
PY
cat > far.mns <<'SCENE'
meniscus 1.0 unit m
param shines = true
let checks = image { file = "checks.png"  projection = planar  scale(<.02, .02, 1>) }
box { from = <-9, -9, -1>  to = <9, 9, 0>
      surface = shines ? surface { albedo = 0  emission = checks } : surface { albedo = checks } }
environment { color = 1 }
camera { from = <0, 0, 90>  to = <0, 0, 0>  fov = 5 }
film { size = <16, 16> }
render { samples = 4 }
SCENE
echo 'meniscus 1.0 unit m  box { from = <-9, -9, -1>  to = <9, 9, 0>  surface = surface { albedo = .5 } }' > even.mns
sed -n '/^environment/,$p' far.mns >> even.mns
run render even.mns -o even.exr -q
for shines in true false; do
    run render far.mns -o "far-$shines.exr" -q -D "shines=$shines"
    exits 0
    run compare "far-$shines.exr" even.exr --max-rmse 0.001 # 0.077 with what was looked up where each ray comes to
    exits 0
done
end

begin "fine relief far from the origin is what it is beside it"
cat > waves.mns <<'SCENE'
meniscus 1.0 unit m
param off = 0
def wave(p) = .5 + .5 * sin(360 * (p.x - off) / .02)
box { from = <off - 1, -1, -1>  to = <off + 1, 0, 1>  surface = surface { albedo = 1  bump = wave  bump_height = .001 } }
light { shape = distant  from = <1, 1, 0>  to = <0, 0, 0>  power = 3 }
camera { from = <off, .3, .0001>  to = <off, 0, 0>  projection = orthographic  width = .04 }
film { size = <64, 8> }
SCENE
for off in 0 100 1000; do
    run render waves.mns -o "waves-$off.exr" -q -s 16 -D "off=$off"
    exits 0
    run compare "waves-$off.exr" waves-0.exr --max-rmse 0.01 # it was even from 100 on: 0.08
    exits 0
done
end

begin "single pixels of a large picture that shines are found"
"$python" - << 'PY'
import struct, zlib
def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
rows = [bytearray(1 + 1024) for y in range(512)]
for x, y in (101, 37), (530, 411), (987, 230):
    rows[y][1 + x] = 255
open('stars.png', 'wb').write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 1024, 512, 8, 0, 0, 0, 0)) +
                              chunk(b'IDAT', zlib.compress(b''.join(rows))) + chunk(b'IEND', b''))
PY
cat > stars.mns <<'SCENE'
meniscus 1.0 unit m
param picture = true
let stars = image { file = "stars.png"  projection = planar  wrap = clamp  scale(<4, 2, 1>)  rotate(x, 90deg) }
if (picture) {
    box { from = <0, 2, 0>  to = <4, 2.0001, 2>  surface = surface { albedo = 0  emission = stars  radiance = 1e5 } }
} else {
    for (p in [<101, 37>, <530, 411>, <987, 230>]) {
        light { shape = quad  size = <4 / 1024, 2 / 512>  radiance = 1e5
                from = <(p.x + .5) / 256, 2, 2 - (p.y + .5) / 256>  to = <(p.x + .5) / 256, 0, 2 - (p.y + .5) / 256> }
    }
}
ground { surface = surface { albedo = .5 } }
camera { from = <2, 1, 1>  to = <2, 0, 1>  up = <0, 0, 1>  fov = 60 }
film { size = <16, 12> }
SCENE
run render stars.mns -o stars.exr -q -s 256
exits 0
run render stars.mns -o lights.exr -q -s 64 -D picture=false
exits 0
run compare stars.exr lights.exr
awk '/^mean of/ { mean[n++] = $5 } END { exit !(mean[0] > 0.95 * mean[1] && mean[0] < 1.05 * mean[1]) }' out ||
    flunk "the picture gives other light than its pixels one by one"
end

begin "a step over a picture that is far away covers what it covers close up"
"$python" - << 'PY'
import struct, zlib
def chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))
rows = b''.join(b'\0' + bytes(0 if x % 4 or y % 2 else 255 for x in range(256)) for y in range(256))
open('net.png', 'wb').write(b'\x89PNG\r\n\x1a\n' + chunk(b'IHDR', struct.pack('>IIBBBBB', 256, 256, 8, 0, 0, 0, 0)) +
                            chunk(b'IDAT', zlib.compress(rows)) + chunk(b'IEND', b''))
PY
cat > net.mns <<'SCENE'
meniscus 1.0 unit m
param away = 10
let net = image { file = "net.png"  projection = planar  ramp = [[0, 0], [.5, 0], [.5, .8], [1, .8]] }
box { from = <-900, -900, -1>  to = <900, 900, 0>  surface = surface { albedo = net } }
environment { color = 1 }
camera { from = <0, 0, away>  to = <0, 0, 0>  fov = 5 }
film { size = <16, 16> }
SCENE
# of each eighth pixel the bilinear picture is above one half in 2 - 2 log(2), 0.614, of its place
for away in 3 10 900; do
    run render net.mns -o net.exr -q -s 256 -D "away=$away"
    exits 0
    run compare net.exr net.exr
    awk '/^mean of A/ { exit !($5 > 0.0594 && $5 < 0.0634) }' out || flunk "it covers another part from $away m: $(grep 'mean of A' out)"
done
end

begin "a picture that is there once: a label of the wall's own colour is not seen, nor is a line about it; of another it is"
label same.png 200 255
for size in 64 4; do # looked up as it is, and in its smaller versions
    cat > wall.mns << SCENE
meniscus 1.0 unit cm
let print = image { file = "same.png"  wrap = once  projection = planar  scale(<4, 4, 1>)  translate(<-2, -2, 0>) }
let mask = print { channel = alpha }
param base = 200
box { from = <-9, -9, -1>  to = <9, 9, 0>
      surface = surface { albedo = mix { from = srgb(base / 255)  to = print  blend = mask } } }
camera { from = <0, 0, 9>  to = <0, 0, 0>  fov = 60 }
environment { color = 1 }
film { size = <$size, $size> }
render { samples = 64 }
SCENE
    sed 's/albedo = mix.*mask }/albedo = srgb(base \/ 255)/' wall.mns > plain.mns
    run render wall.mns -o wall.exr -q
    exits 0
    run render plain.mns -o plain.exr -q
    exits 0
    run compare wall.exr plain.exr --max-rmse 0.002
    exits 0
    run render wall.mns -D base=20 -o wall.exr -q
    run render plain.mns -D base=20 -o plain.exr -q
    run compare wall.exr plain.exr --max-rmse 0.05
    [ "$status" != 0 ] || flunk "no label"
done
end

begin "a picture in a plane is on both sides, and by a function of the normal on one"
label black.png 0 255
cat > wall.mns << SCENE
meniscus 1.0 unit cm
let print = image { file = "black.png"  wrap = once  projection = planar  scale(<4, 4, 1>)  translate(<-2, -2, 0>) }
def front(p, normal) = normal.z > .5 ? 1 : 0
param side = 1
param sides = 2
let all = print { channel = alpha }
let mask = sides == 0 ? 0 : sides == 1 ? mix { from = 0  to = all  blend = front } : all
box { from = <-9, -9, -1>  to = <9, 9, 1>  surface = surface { albedo = mix { from = .8  to = print  blend = mask } } }
camera { from = <0, 0, 9 * side>  to = <0, 0, 0>  fov = 60 }
environment { color = 1 }
film { size = <32, 32> }
render { samples = 16 }
SCENE
for side in 1 -1; do
    for sides in 0 1 2; do
        run render wall.mns -D side=$side -D sides=$sides -o wall$side$sides.exr -q
        exits 0
    done
done
run compare wall11.exr wall12.exr --max-rmse 0.001
exits 0
run compare wall-11.exr wall-10.exr --max-rmse 0.001
exits 0
run compare wall-12.exr wall-10.exr --max-rmse 0.05
[ "$status" != 0 ] || flunk "not on the far side"
end

begin "a label that was rendered comes back as it was by EXR, and by PNG without the tones of film"
cat > paper.mns << SCENE
meniscus 1.0 unit mm
param file = ""
let paper = file == "" ? rgb(.85, .5, .1) : image { file = file  projection = planar  translate(<-.5, -.5, 0>)  scale(20) }
box { from = <-10, -10, -1>  to = <10, 10, 0>  surface = surface { albedo = 0  emission = paper } }
camera { projection = orthographic  from = <0, 0, 50>  to = <0, 0, 0>  width = 16 }
film { size = <32, 32>  alpha = true }
render { samples = 16 }
SCENE
run render paper.mns -o paper.exr -q
exits 0
run view paper.exr -o film.png
exits 0
run view paper.exr -o plain.png --view Un-tone-mapped
exits 0
for file in paper.exr plain.png film.png; do
    run render paper.mns -D "file=\"$file\"" -o back.exr -q
    exits 0
    run compare back.exr paper.exr --max-rmse 0.02
    case $file in
    film.png) [ "$status" != 0 ] || flunk "$file: as it was" ;;
    *) exits 0 ;;
    esac
done
end

begin "a label on glass: what is clear of the picture lets light through as the glass does"
label none.png 200 0
label all.png 200 255
for name in none all; do
    cat > $name.mns << SCENE
meniscus 1.0 unit cm
medium glass { ior = 1.5 }
let print = image { file = "$name.png"  wrap = once  projection = planar  scale(<8, 8, 1>)  translate(<-4, -4, 0>) }
box { from = <-9, -9, -1>  to = <9, 9, 0>  interior = glass
      surface = surface { mix = [surface { ior = 1.5  transmission = 1 }, surface { albedo = print  transmission = 0  ior = 1.5 }]
                          weight = print { channel = alpha } } }
box { from = <-9, -9, -4>  to = <9, 9, -3>  surface = surface { albedo = rgb(.8, .1, .1) } }
camera { from = <0, 0, 30>  to = <0, 0, 0>  fov = 20 }
environment { color = 1 }
film { size = <32, 32>  filter = box }
render { samples = 256  seed = 3 }
SCENE
done
sed '/surface = surface { mix/,/weight/d; s/interior = glass/interior = glass }/' none.mns > bare.mns
for name in none all bare; do
    run render $name.mns -o $name.exr -q
    exits 0
done
run compare none.exr bare.exr --max-rmse 0.02
exits 0
run compare all.exr bare.exr --max-rmse 0.1
[ "$status" != 0 ] || flunk "no label"
end

begin "an unknown colour space: status 3, with the place"
png flat.png 1 1 9 9 9
ball space.mns 'albedo = image { file = "flat.png"  colorspace = "nowhere" }'
run check space.mns
exits 3
matches err '^space\.mns:2:[0-9]+: error: .*nowhere'
end

begin "pictures that are cut short, no pictures, or too large to be true: status 3, with the file's name"
png whole.png 40 40 1 2 3
head -c 60 whole.png > cut.png
echo 'hello' > text.png
printf '\377\330\377\340hello' > broken.jpg
printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4 +X 8\n\002\002\000\010\210a' > broken.hdr
printf '#?RADIANCE\nFORMAT=Radiance_spectra\n\n-Y 1 +X 1\n1234' > spectra.hdr
"$python" -c '
import struct, zlib
def chunk(kind, body):
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
open("huge.png", "wb").write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 65000, 65000, 8, 2, 0, 0, 0))
    + chunk(b"IDAT", zlib.compress(b"\0" * 1000)) + chunk(b"IEND", b""))'
: > empty.png
for file in cut.png text.png broken.jpg huge.png empty.png broken.hdr spectra.hdr; do
    ball bad.mns "albedo = image { file = \"$file\" }"
    run check bad.mns
    exits 3
    matches err "^bad\.mns:2:[0-9]+: error: cannot read '.*$file'"
done
end

begin "a picture of Radiance's lights a scene, covers a surface, and is viewed, compared and described as an EXR file is"
"$python" -c '
line = b"\2\2\0\x10" + b"".join(bytes([144, byte]) for byte in (159, 127, 95, 131))
open("sky.hdr", "wb").write(b"#?RADIANCE\nSOFTWARE=a test\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=2\n\n-Y 8 +X 16\n" + 8 * line)'
ball by-image.mns 'albedo = .5'
sed 's/environment { color = .5 }/environment { image = "sky.hdr" }/' by-image.mns > sky.mns
sed 's/environment { color = .5 }/environment { color = rgb(159.5, 127.5, 95.5) \/ 64 }/' by-image.mns > colour.mns
run render sky.mns -o sky.exr
exits 0
run render colour.mns -o colour.exr
exits 0
run compare sky.exr colour.exr --max-rmse 0.04
exits 0
sed 's/albedo = .5/albedo = image { file = "sky.hdr"  clip = true }/' by-image.mns > covered.mns
run check covered.mns
exits 0
run view sky.hdr -o sky.png
exits 0
run compare sky.hdr sky.hdr --max-rmse 0
exits 0
matches out '^mean of B +2.49219 1.99219 1.49219$'
run info sky.hdr
exits 0
matches out '^SOFTWARE +a test$'
matches out '^EXPOSURE +2$'
matches out '^width +16$'
printf '#?RADIANCE\nFORMAT=Radiance_spectra\n\n-Y 1 +X 1\n1234' > spectra.hdr
run info spectra.hdr
exits 4
says err 'save it as one of these, or as .exr'
end

begin "a value that no surface reflects: file, pixel, value and cure; clip holds it"
cat > bright.mns << 'SCENE'
meniscus 1.0 unit cm
sphere { surface = surface { albedo = 0  emission = rgb(3, 2, 1) } }
camera { from = <0, 0, 5>  to = <0, 0, 0>  fov = 2 }
film { size = <4, 4> }
render { samples = 1 }
SCENE
run render bright.mns -o bright.exr
exits 0
ball over.mns 'albedo = image { file = "bright.exr" }'
run check over.mns
exits 3
matches err "bright\.exr' has the value [23].* in the (red|green|blue) of pixel <0, 0>"
says err 'clip = true'
ball clipped.mns 'albedo = image { file = "bright.exr"  clip = true }'
run check clipped.mns
exits 0
ball shines.mns 'albedo = 0  emission = image { file = "bright.exr" }'
run check shines.mns
exits 0
end

begin "a picture's contents are part of the scene's hash, and its file is one of those that a render reads"
png flat.png 2 2 10 20 30
ball hashed.mns 'albedo = image { file = "flat.png" }'
one=$(scene_hash hashed.mns)
png flat.png 2 2 10 20 31
two=$(scene_hash hashed.mns)
[ -n "$one" ] && [ "$one" != "$two" ] || flunk "the hash does not see the picture"
mkdir inner
cp hashed.mns inner
run check inner/hashed.mns --confine inner
exits 3
says err 'flat.png'
end

begin "textures stay what they are when dumped and formatted"
cat > many.mns << 'SCENE'
meniscus 1.0 unit cm
let wall = brick { size = <8, 3, 4>  ramp = [#999, #a43]  rotate(y, 10)  scale(.1) }
let cloud = noise { octaves = 3 }
surface bricks { albedo = wall  ior = 1.5  roughness = wall { ramp = [.8, .2]  translate(<1, 2, 3>) }  bump = cloud { scale(3) } bump_height = .2 }
sphere { surface = bricks }
box { size = <1, 1, 1>  translate(<3, 0, 0>) rotate(<10, 20, 30>)
  surface = surface { albedo = mix { from = wall  to = cloud { from = .2  to = rgb(.5, .3, .2) }  blend = cloud } emission = cloud } }
camera { from = <0, 0, 9>  to = <0, 0, 0> }
SCENE
same_flat many.mns
end
