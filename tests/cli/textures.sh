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
