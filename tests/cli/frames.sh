# frames.sh - animations: which frames, what they are called, what is left out, and what stops them.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# a scene of 6 frames, whose camera comes nearer
moving_scene() {
    small_scene
    sed -i 's/^camera {.*/camera { from = <0, 10, -30 + 10 * clock>  to = <0, 5, 0>  fov = 30 }/' small.mns
    { cat small.mns; echo 'animation { frames = 6  fps = 2 }'; } > moving.mns
}
# frames_there NAME...: these and no other pictures
frames_there() {
    wanted=$(printf '%s\n' "$@")
    found=$(ls -1 -- *.exr *.png 2> /dev/null)
    [ "$found" = "$wanted" ] || flunk "there are: $(echo $found)"
}

begin "all frames, one after the other, with numbers in their names"
moving_scene
run render moving.mns
exits 0
frames_there moving.0001.exr moving.0002.exr moving.0003.exr moving.0004.exr moving.0005.exr moving.0006.exr
cmp -s moving.0001.exr moving.0002.exr && flunk "two frames are the same"
matches err '^wrote moving\.0006\.exr '
matches err '^Progress: 50% \(frame 3\)$'
matches err '^Progress: 100% \(frame 6\)$'
matches err '^rendered 6 frames in '
run info moving.0004.exr
matches out '^meniscus/frame +4$'
no_leftovers
end

begin "frames of choice are those of the whole animation"
moving_scene
run render moving.mns -q
mkdir whole
mv moving.*.exr whole
run render moving.mns --frames 2..6/2
exits 0
frames_there moving.0002.exr moving.0004.exr moving.0006.exr
for f in moving.*.exr; do cmp -s "$f" "whole/$f" || flunk "$f is another picture"; done
matches err '^rendered 3 frames in '
run render moving.mns --frames 5 -o f.##.png -o 'x.#.exr'
run render moving.mns --frame 3 -o still.exr
says err 'wrote still.0003.exr '
frames_there f.05.png moving.0002.exr moving.0004.exr moving.0006.exr still.0003.exr x.5.exr
cmp -s still.0003.exr whole/moving.0003.exr || flunk "frame 3 is another picture"
run render moving.mns --frame 3 -o - -q
exits 0
cmp -s out still.0003.exr || flunk "not the picture of frame 3"
run render moving.mns --frames 2 --frame 4 -q
there moving.0004.exr
end

begin "standard input is read once for all frames"
moving_scene
"$program" render - -o 'piped.#.exr' < moving.mns > out 2> err
status=$?
exits 0
there piped.6.exr
"$program" check - --frames all < moving.mns > out 2> err
status=$?
exits 0
end

# clock_of ARGUMENT...: the file out holds frame, frames, clock and time
clock_of() { run dump clock.mns "$@"; exits 0; }
begin "clock, time, frame and frames"
small_scene
{ cat small.mns; echo 'print(frame, " of ", frames, ", clock ", clock, ", time ", time)'; } > clock.mns
clock_of
says err '1 of 1, clock 0, time 0'
echo 'animation { frames = 5  fps = 2  cyclic = true  first_frame = 10 }' >> clock.mns
clock_of
says err '10 of 5, clock 0, time 0'
clock_of --frame 12
says err '12 of 5, clock 0.4, time 1'
clock_of --frame 14 --set animation.cyclic=false
says err '14 of 5, clock 1, time 2'
clock_of --clock .25
says err '10 of 5, clock 0.25, time 0.625'
clock_of --frame 0 --set animation.first_frame=0
says err '0 of 5, clock 0, time 0'
run render clock.mns --clock .5 -o a.exr
exits 0
there a.exr
says err '10 of 5, clock 0.5, time 1.25'
run params clock.mns --frame 11
exits 0
end

begin "what a scene divides by is known when it is evaluated"
moving_scene
{ echo 'meniscus 1.0 unit cm'; echo 'let turn = 360 / (frames - 1)  assert(frames == 6)  print("turn ", turn)'
  sed 1d moving.mns; } > late.mns
run check late.mns
exits 0
says err 'turn 72'
says_not err error
end

begin "dump: one frame, which keeps its number and its picture"
moving_scene
run dump moving.mns --frame 4
exits 0
says out 'animation { frames = 1  first_frame = 4  fps = 2 }'
mv out flat.mns
run render flat.mns -o flat.exr
run render moving.mns --frame 4
run compare flat.exr moving.0004.exr --max-rmse 0
exits 0
end

begin "the animation cannot depend on the clock, nor the film's output"
moving_scene
sed 's/frames = 6/frames = 6 + floor(3 * clock)/' moving.mns > bad.mns
run render bad.mns
exits 3
says err '[clock-dependent]'
matches err '^bad\.mns:[0-9]+:[0-9]+: error:'
sed 's/frames = 6/frames = frames + 1/' moving.mns > bad.mns
run check bad.mns
exits 3
says err '[clock-dependent]'
sed 's/size = <16, 16>/size = <16, 16>  output = frame == 1 ? "a.#.exr" : "b.#.exr"/' moving.mns > bad.mns
rm -f *.exr
run render bad.mns
exits 3
says err '[clock-dependent]'
says err 'in frame 6'
says err "'#' stands for the number of the frame"
says_not err wrote
gone a.0001.exr
run check --frames all bad.mns
exits 3
says err '[clock-dependent]'
run check --frame 2 bad.mns
exits 0
run render bad.mns --frames 1..2 -o own.#.exr
exits 0
sed 's/frame == 1/frame != 4/' bad.mns > middle.mns
for command in 'check' 'check --frames all' 'render'; do
    run $command middle.mns
    exits 3
    says err '[clock-dependent]'
    says err 'in frame 4'
done
gone a.0001.exr
sed 's/frames = 6/frames = 5 + frame/' moving.mns > bad.mns
run render bad.mns
exits 3
says err '[clock-dependent]'
says_not err wrote
run check bad.mns
exits 3
end

begin "frames that there are not"
moving_scene
run render moving.mns --frame 7
exits 2
says err "there is no frame 7: the scene's animation has the frames 1 to 6"
run render moving.mns --frames 4..9
exits 2
says err '4..9'
run render small.mns --frames 1..3
exits 2
says err '--set animation.frames='
run render small.mns --frames 1..3 --set animation.frames=3 -q
exits 0
there small.0003.exr
run render small.mns --frame 2
exits 2
says err '--set animation.frames='
for wrong in 0..x 3..1 1..4/0 1-4 '' 1..4..2 -1; do
    run render moving.mns --frames "$wrong"
    exits 2
done
for wrong in 1-4 1:4; do
    run render moving.mns --frames "$wrong"
    says err "'$wrong' is no range here; write 1..4"
done
for wrong in 0/3 4/3 3 1/ 1/2/3; do
    run render moving.mns --shard "$wrong"
    exits 2
done
run render moving.mns --clock .5 --frames 1..2
exits 2
run render moving.mns --clock .5 --shard 1/2
exits 2
run render moving.mns -o - -q
exits 2
says err 'standard output takes one picture'
run render moving.mns -o 'a#.exr' -o 'a1#.exr' --set animation.frames=12 --set animation.first_frame=1
exits 2
says err "'a11.exr' would be written for two frames"
run render moving.mns --frames 1..2 -o 'a#.exr' -o './a#.exr'
exits 2
says err "output './a1.exr' is named twice"
end

begin "all files of all frames are tried before the first is rendered"
moving_scene
mkdir f.0005.exr
run render moving.mns -o f.####.exr
exits 5
says err "cannot write 'f.0005.exr': it is a folder"
gone f.0001.exr
run render moving.mns -o a.exr --stats=missing/s.json
exits 5
gone a.0001.exr
end

begin "a mistake in one frame: which one, and what was done stays"
moving_scene
echo 'assert(frame != 4, "no fourth")' >> moving.mns
run render moving.mns
exits 3
says err 'no fourth [assertion]'
says err 'in frame 4'
matches err '^moving\.mns, frame 4: 1 error$'
matches err '^rendered 3 frames of 6 in '
frames_there moving.0001.exr moving.0002.exr moving.0003.exr
run render moving.mns --frames 5..6
exits 0
run render moving.mns --log-format json
exits 3
while read -r line; do printf '%s\n' "$line" > line; is_json line; done < err
says err '"event": "diagnostics", "frame": 4'
says err '"event": "done", "frame": 3'
says err '"framesTotal": 6'
says err '"event": "frames", "wanted": 6, "rendered": 3, "skipped": 0'
end

begin "a mistake in the last frame, until its shutter closes, is told before the first is rendered"
moving_scene
sed -i 's/^camera { /&shutter = 180  /' moving.mns
sed 's/albedo = [^ ]*/albedo = clock/' moving.mns > fade.mns
echo 'sphere fades { radius = 1  surface = surface { albedo = clock }  translate(<clock, 20, 0>) }' >> fade.mns
run check fade.mns --frames all
exits 0
says err "'albedo' of fades changes while the shutter is open"
run render fade.mns
exits 0
there fade.0006.exr
for late in 'assert(clock <= 1, "too late")' 'let steps = [1, 2, 3, 4, 5, 6]  print(steps[floor(5 * clock + .6)])'; do
    { cat moving.mns; echo "$late"; } > late.mns
    for command in 'check' 'check --frames all' 'render'; do
        run $command late.mns
        exits 3
        says err '[shutter-mistake]'
        says err 'in frame 6'
        says err 'min(clock, 1)'
        matches err '^late\.mns: 1 error$'
    done
    gone late.0001.exr
    run render late.mns --frames 1..2
    exits 0
    rm -f late.*.exr
done
{ cat moving.mns; echo 'sphere { radius = 1  surface = surface { albedo = 1.05 * clock } }'; } > bright.mns
for command in 'check' 'check --frames all' 'render'; do
    run $command bright.mns
    exits 3
    says err 'albedo 1.05 is outside 0..1'
    says err 'in frame 6'
done
gone bright.0001.exr
end

begin "a warning is said once for all frames; print in each"
moving_scene
echo 'warn("careful")  print("frame ", frame)' >> moving.mns
run render moving.mns --frames 2..4
exits 0
[ "$(grep -c 'warning: careful' err)" = 1 ] || flunk "the warning stands there more than once"
for i in 2 3 4; do matches err "^frame $i\$"; done
says_not err 'frame 1'
run render moving.mns --frames 2..4 -q
grep -qx 'frame 2' err && flunk 'print is not quiet'
says err 'warning: careful'
run render moving.mns --werror
exits 3
# of what is never used, too, and of a frame that is rendered
sed '$d' moving.mns > unused.mns
echo 'use "std/media.mns" as media' >> unused.mns
for options in '--frames 2..3' '--frames 3' '--frames 2..3 --skip-existing'; do
    run render unused.mns $options
    exits 0
    [ "$(grep -c unused-name err)" -le 1 ] || flunk "the warning stands there more than once"
    says_not err 'frame 1:'
done
run render unused.mns --frames 2..3 -q
[ "$(grep -c unused-name err)" = 1 ] || flunk "the warning is not there once"
matches err '^unused\.mns, frame 2: 1 warning$'
end

begin "check: each mistake once, with its frames; the report is of the first frame"
moving_scene
echo 'if (frame >= 3) { warn("late, at ", clock) }  if (frame == 5) { sphere { radius = frame - 9 } }' >> moving.mns
run check moving.mns
exits 0
says_not err late
run check moving.mns --frames all
exits 3
[ "$(grep -c 'warning: late' err)" = 1 ] || flunk "the warning stands there more than once"
says err 'in frames 3 to 6'
says err 'in frame 5'
matches err '^moving\.mns: 1 error, 1 warning$'
run check moving.mns --frames all --json
exits 3
is_json out
says out '"frames": [{"first": 3, "last": 6, "step": 1}]'
run check moving.mns --frames 1..4/3
exits 0
says err 'in frame 4'
there out
end

begin "what is there is skipped"
moving_scene
run render moving.mns --frames 2..3 -q
echo mine > moving.0003.exr
run render moving.mns --skip-existing
exits 0
[ "$(cat moving.0003.exr)" = mine ] || flunk "frame 3 was written again"
matches err '^rendered 4 frames in .*; 2 were there already$'
run render moving.mns --skip-existing
exits 0
matches err '^rendered no frame in .*; 6 were there already$'
rm moving.0005.exr
run render moving.mns --skip-existing -o moving.exr -o moving.png
exits 0
matches err '^rendered 6 frames in '
run render small.mns -o small.exr -q
run render small.mns -o small.exr --skip-existing
exits 0
matches err '; 1 was there already$'
end

begin "shares are all of the frames, and none twice"
moving_scene
run render moving.mns --shard 1/4
frames_there moving.0001.exr moving.0005.exr
for i in 2 3 4; do
    run render moving.mns --shard $i/4 --skip-existing
    exits 0
    says_not err 'there already'
done
frames_there moving.0001.exr moving.0002.exr moving.0003.exr moving.0004.exr moving.0005.exr moving.0006.exr
run render moving.mns --frames 1..2 --shard 3/3
exits 0
says err 'this share holds none'
end

begin "statistics of each frame"
moving_scene
run render moving.mns --frames 1..2 --stats=s.json -q
exits 0
is_json s.0001.json
says s.0002.json '"frame": 2'
end

begin "a signal ends an animation; the frame that it stops is not written"
moving_scene
sed -i 's/samples = 4/samples = frame < 3 ? 4 : 16777216/' moving.mns
run_till '"samplesTotal": 16777216' INT render moving.mns
exits 130
frames_there moving.0001.exr moving.0002.exr
says err 'this frame is not written'
matches err '^rendered 2 frames of 6 in '
no_leftovers
run_till "$sampling" INT render moving.mns --frame 3
exits 130
there moving.0003.exr
end

begin "a time limit is each frame's"
moving_scene
sed -i 's/samples = 4/samples = 16777216/' moving.mns
run render moving.mns --frames 1..2 -t 0.2s
exits 0
frames_there moving.0001.exr moving.0002.exr
end

begin "frames: the number of a frame by the ways of C is answered with '#'"
small_scene
run render small.mns -o 'frame%03d.png'
exits 2
says err "'%03d' is no place for the number of a frame in the output 'frame%03d.png'; write: frame####.png"
for mark in '$F3' '$F' '<frame>' '{frame}'; do
    run render small.mns -o "frame$mark.png"
    exits 2
    says err "'$mark' is no place for the number of a frame in the output 'frame$mark.png'; write: frame####.png"
done
sed 's/size = <16, 16>/size = <16, 16>  output = "f%d.exr"/' small.mns > other.mns
run check other.mns
exits 3
says err 'write: "f####.exr"'
no_leftovers
end

begin "a camera that flies through a pane: a frame in which it is right on a surface is rendered, too, and a warning says so"
cat > fly.mns <<'SCENE'
meniscus 1.0 unit cm
animation { frames = 3 }
medium glass { ior = 1.5  state = solid }
box pane { interior = glass  from = <-5, -5, -1>  to = <5, 5, 2> }
camera { from = <0, 0, 4 - frame>  to = <0, 0, -9>  aperture = .1  focus = <0, 0, -9> }
environment { color = 1 }
film { size = <4, 3> }
render { samples = 4 }
SCENE
run render fly.mns -o fly.exr --progress none
exits 0
there fly.0001.exr
there fly.0002.exr
there fly.0003.exr
says err "in frame 2 camera 1 is on the surface of pane: it is taken to be just beyond it, the way that it looks"
run render fly.mns --frame 2 --pixel 1,1 --aov medium
exits 0
run check fly.mns --frame 2 --pixel 1,1
says out "Along the line, which starts in glass"
sed 's/^animation.*//; s/4 - frame/2/' fly.mns > stands.mns
run check stands.mns
exits 3
says err "[camera-on-surface]"
end
