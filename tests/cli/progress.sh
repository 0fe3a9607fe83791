# progress.sh - the forms of progress, and colours.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "plain progress where there is no terminal"
small_scene
run render small.mns -o a.exr -s 64
exits 0
matches err '^Progress: 100%$'
[ "$(grep -c '^Progress: ' err)" -le 11 ] || flunk "too many lines"
grep -v '^Progress: [0-9]*%$' err | grep -q '^Progress' && flunk "a line with more than the figure"
says_not err "$(printf '\033')"
end

begin "progress as JSON, and none"
small_scene
run render small.mns -o a.exr --progress json -q
while read -r line; do printf '%s\n' "$line" > line; is_json line; done < err
says err '"event": "progress"'
run render small.mns -o a.exr --progress none
says_not err Progress
run render small.mns -o a.exr -q
empty err
end

begin "a bar on a terminal, a plain line on a dumb one"
long_scene
on_terminal xterm render long.mns -t 1s -o a.exr
says out 'Mrays/s'
says out "$(printf '\033[K')"
on_terminal xterm render long.mns -t 1s -o a.exr --progress none
says_not out 'rays/s'
on_terminal dumb render long.mns -t 1s -o a.exr
says_not out "$(printf '\033')"
end

begin "what is being built, once it takes a while"
cat > slow.mns << 'END'
meniscus 1.0 unit mm
camera { from = <0, -5, 2>  to = <0, 0, 0> }
environment { color = 1 }
def rough(p) = length(p) - 1 + sum([for (i in 1..26) .002 * noise(p * i)])
isosurface rock { function = rough  from = vec3(-1.3)  to = vec3(1.3)  cells = 100  surface = surface { albedo = .7 } }
END
on_terminal xterm render slow.mns -s 1 --size 8x8 -o a.exr
says out "building the isosurface 'rock', for 1 s"
end

begin "colours: on a terminal, not with NO_COLOR, always, never"
printf 'meniscus 1.0 unit mm\nsphere { radius = }\n' > bad.mns
on_terminal xterm check bad.mns
says out "$(printf '\033[')"
NO_COLOR=1
export NO_COLOR
on_terminal xterm check bad.mns
says_not out "$(printf '\033[')"
unset NO_COLOR
on_terminal xterm check bad.mns --color never
says_not out "$(printf '\033[')"
run check bad.mns --color always
says err "$(printf '\033[')"
run check bad.mns
says_not err "$(printf '\033[')"
end

begin "no picture to a terminal"
small_scene
on_terminal xterm render small.mns -o -
says out "standard output is a terminal"
end

begin "a noise: pixels stop by themselves, and the closing line says what was reached"
cat > noisy.mns <<'SCENE'
meniscus 1.0 unit mm
ground { surface = surface { albedo = .8 } }
sphere { center = <0, 1, 0>  radius = 1  surface = surface { albedo = .2 } }
light { shape = sphere  from = <3, 5, 2>  radius = .3  color = 40 }
camera { from = <0, 3, 9>  to = <0, 1, 0>  fov = 30 }
film { size = <32, 32> }
SCENE
run render noisy.mns -o a.exr -n 1% --aov samples --stats=stats.json
exits 0
matches err '^wrote a\.exr \(32 x 32, [0-9]+ to [0-9]+ samples, [0-9.]+ on average, noise [0-9.]+ %, 0 nesting faults\) in '
"$python" - <<'PYTHON' || flunk "the statistics"
import json
s = json.load(open("stats.json"))
assert s["noiseWanted"] == 0.01 and 0 < s["noise"] < 0.01 and s["noisyPixels"] == 0, s
assert s["samplesWanted"] == 4096 and 16 <= s["samples"] < s["meanSamples"] < s["mostSamples"] < 4096, s
PYTHON
run render noisy.mns -o reference.exr -s 4096 --seed 5 -q
run compare a.exr reference.exr
"$python" - <<'PYTHON' || flunk "the error that compare measures is not the one that was stated"
import json
stated = json.load(open("stats.json"))["noise"]
measured = float([l for l in open("out") if l.startswith("relative error")][0].split()[2])
assert measured / 1.25 < stated < measured * 1.25, (stated, measured)
PYTHON
run render noisy.mns -o b.exr -n 0.1% -s 64
exits 0
matches err 'noise [0-9.]+ %, [0-9.]+ % of the pixels above 0\.1 % at 64 samples, 0 nesting'
run render noisy.mns -o b.exr -n 0.001% -s 2000 --size 8x6
exits 0
matches err '^wrote b\.exr \(8 x 6, [0-9]+ to 2000 samples, [0-9]{4} on average, noise [0-9.]+ %, 1?[0-9]{2} % of the pixels above 0\.001 %'
run render noisy.mns -o c.exr -n 2% -j 1 -q
run render noisy.mns -o d.exr -n 2% -j 3 -q
cmp -s c.exr d.exr || flunk "not the same bits for 1 and 3 threads"
run render noisy.mns -o e.exr -n 0.4% --size 128x128 --progress json -q
"$python" - <<'PYTHON' || flunk "the progress"
import json
lines = [json.loads(l) for l in open("err")]
fractions = [l["fraction"] for l in lines]
assert fractions == sorted(fractions) and 0 <= fractions[0] and fractions[-1] <= 1, fractions
for l in lines:
    low, high = l["secondsLeftLow"], l["secondsLeftHigh"]
    assert (low is None) == (high is None) and (low is None or 0 <= low <= high), l
PYTHON
while read -r line; do printf '%s\n' "$line" > line; is_json line; done < err
end
