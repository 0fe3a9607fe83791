# catcher.sh - shadow catchers: pictures to be laid over another one, made in one go, in slices and in parts.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

caught_scene() {
    cat > caught.mns <<'SCENE'
meniscus 1.0 unit cm
medium glass { ior = 1.5  tint = rgb(.9, .5, .2)  depth = 2cm }
param there = true
if (there) {
    sphere ball { center = <-2, 2, 0>  radius = 2  interior = glass }
    sphere { center = <3, 1, 1>  radius = 1  surface = surface { albedo = rgb(.1, .3, .8) } }
}
surface table { albedo = .5  shadow_catcher = true }
ground { surface = table }
environment { color = .3  visible = false }
light { from = <3, 15, -4>  to = <0, 0, 0>  size = <1, 1>  radiance = 150 }
camera { from = <0, 10, -30>  to = <0, 1, 0>  fov = 30  aperture = 1mm  focus = <0, 2, -2> }
film { size = <40, 30>  alpha = true }
render { samples = 64 }
SCENE
}

begin "a shadow catcher as a PNG file: things are opaque, shadows dark and transparent, all else is clear"
caught_scene
run render caught.mns -o a.exr -o a.png --aov object
exits 0
says_not err warning
run view a.exr -o viewed.png --alpha on
exits 0
cmp -s a.png viewed.png || flunk "the EXR file shows another picture"
sed 's/shadow_catcher = true/shadow_catcher = false/' caught.mns > plain.mns
run render plain.mns -o plain.png
exits 0
PYTHONPATH=$root/tests/cli "$python" -B - <<'PYTHON' || flunk "not the pixels that there should be"
from pixels import pixels
a, plain = pixels("a.png"), pixels("plain.png")
flat, whole = [p for row in a for p in row], [p for row in plain for p in row]
assert all(p[3] == 255 for p in whole[20 * 40:])                    # the ground is there for all but the picture
opaque = [i for i, p in enumerate(flat) if p[3] == 255]
assert 40 < len(opaque) < 300, len(opaque)
unlike = [i for i in opaque if any(abs(flat[i][c] - whole[i][c]) > 2 for c in range(3))]
assert len(unlike) < 5, [(flat[i], whole[i]) for i in unlike]       # things are as they were, but for single bright samples
shadows = [p for p in flat if 60 < p[3] < 230]
assert len(shadows) > 20, len(shadows)
assert any(max(p[:3]) < 40 for p in shadows)                        # of what is opaque: dark
assert any(p[0] > 2 * p[2] and p[0] > 60 for p in shadows)          # of glass: with its colour
assert sum(p[3] < 8 for p in flat) > 500                            # and all else of the ground is clear
PYTHON
run render caught.mns -o empty.exr -D there=false
exits 0
says err "the picture is empty: no thing is in it, and none changes the light of its shadow catchers"
end

begin "shadow catchers in slices, in parts and by several threads: the same picture, byte for byte"
caught_scene
for options in "-s 64" "-s 64 --denoise on --crop 4,4,36,29"; do
    rm -f ./*.exr
    run render caught.mns $options -o whole.exr -q -j 1
    exits 0
    for range in 1..7 8..40 41..64; do
        run render caught.mns $options --sample-range $range -o $range.exr -q -j 2
        exits 0
    done
    run merge -o merged.exr 41..64.exr 1..7.exr 8..40.exr
    exits 0
    cmp -s whole.exr merged.exr || flunk "slices make another picture, with $options"
    status=75 n_parts=0
    while [ $status -eq 75 ] && [ $n_parts -lt 60 ]; do
        run render caught.mns $options -o parts.exr --resume -t 0.3s -q
        n_parts=$((n_parts + 1))
    done
    exits 0
    cmp -s whole.exr parts.exr || flunk "parts make another picture, with $options"
done
run render caught.mns -s 100000 -o stopped.exr --resume -t 0.3s
sed -i 's/shadow_catcher = true/shadow_catcher = false/' caught.mns
run render caught.mns -s 100000 -o stopped.exr --resume -t 0.3s
exits 4
says err "as there has changed: its surfaces"
end

begin "shadow catchers with a noise to be reached, adaptively, and with single bright samples kept"
caught_scene
for options in "-n 5%" "--adaptive on" "--fireflies keep" "--caustics on" "--preview now.png"; do
    run render caught.mns $options -s 32 -o a.exr
    exits 0
    there a.exr
done
end
