# checkpoints.sh - renders that are stopped and go on: to the same picture, bit for bit; and what is refused.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# stop_and_resume NAME ARGUMENT...: NAME.exr, rendered with INT after INT, by one thread and two
stop_and_resume() {
    file=$1 stops=0 status=130 wait=0.9 kept=no
    shift
    while [ $status -eq 130 ] && [ $stops -lt 40 ]; do
        run_until $wait INT render kept.mns -o "$file.exr" --resume -j $((1 + stops % 2)) "$@"
        [ ! -s "$file.checkpoint.exr" ] || kept=yes # a stop before the first photon or sample leaves none
        stops=$((stops + 1))
        wait=$((1 + stops / 4)).5
    done
    exits 0
    gone "$file.checkpoint.exr"
}

begin "stopped and resumed, with whatever threads: the same file, byte for byte"
kept_scene
sed -i 's/samples = 200/samples = 600/' kept.mns
run render kept.mns -o whole.exr --aov all -q
exits 0
stop_and_resume parts --aov all
cmp -s whole.exr parts.exr || flunk "the pictures differ"
[ $kept = yes ] || flunk "it was never stopped"
no_leftovers
end

begin "resumed behind one sample: it is said as one"
small_scene
run render small.mns --sample-range 1..1 -o a.exr
exits 0
run render small.mns --sample-range 1..1 --resume -o a.exr
exits 0
says err "1 sample of each pixel is there"
end

begin "the same with a noise to be reached"
kept_scene
run render kept.mns -o whole.exr -n 2.5% -s 4000 -q
exits 0
stop_and_resume parts -n 2.5% -s 4000
cmp -s whole.exr parts.exr || flunk "the pictures differ"
[ $kept = yes ] || flunk "it was never stopped"
end

begin "what noise a checkpoint's render is to come to"
kept_scene
run render kept.mns -o a.exr -n 0.01% -s 16000000 -t 0.4 --checkpoint 1h -q
exits 75
run info a.checkpoint.exr
matches out '^state: noise to come to +0\.01 %$'
end

begin "the same of an adaptive render that is denoised"
kept_scene
run render kept.mns -o whole.exr --adaptive on --denoise on -s 600 -q
exits 0
stop_and_resume parts --adaptive on --denoise on -s 600
cmp -s whole.exr parts.exr || flunk "the pictures differ"
[ $kept = yes ] || flunk "it was never stopped"
end

begin "a time limit leaves a checkpoint, and status 75; more samples can follow"
kept_scene
run render kept.mns -o a.exr -s 16000000 -t 0.5 --checkpoint 1h
exits 75
there a.exr
says err 'a.checkpoint.exr is there to go on from with --resume'
run info a.checkpoint.exr
exits 0
matches out '^state: samples +1\.\.16000000 of 16000000$'
run view a.checkpoint.exr -o a.png
exits 0
run render kept.mns -o a.exr -s 16000000 -t 0.5
exits 0
there a.checkpoint.exr
run render kept.mns -o a.exr --checkpoint 1h -s 4
exits 2
says err "there is a checkpoint 'a.checkpoint.exr'"
run render kept.mns -o a.exr --restart -s 4
exits 0
gone a.checkpoint.exr
run render kept.mns -o a.exr --resume --restart
exits 2
run render kept.mns -o a.exr --resume -s 4 # nothing is there: from the start
exits 0
end

begin "a time limit amid photons: a picture without them, and the next piece goes on with them, to the same picture in the end"
kept_scene
sed -i 's/samples = 200/samples = 20000  caustics = on/' kept.mns
run render kept.mns --size 8x6 -o whole.exr -q
exits 0
run render kept.mns --size 8x6 -o a.exr --checkpoint 1h -t 0.001 -j 1 # which is over before the first photon
exits 75
there a.exr
says err 'photons for caustics were on their way: the picture is one without these'
says err 'a.checkpoint.exr is there to go on from with --resume'
run info a.checkpoint.exr
matches out '^state: photons for caustics +on their way$'
matches out '^state: done, at most +0$'
run merge a.checkpoint.exr -o merged.exr
exits 4
says err 'has only 0 of its 20000 samples'
rm a.exr
pieces=0 status=75
while [ $status -eq 75 ] && [ $pieces -lt 100 ]; do
    limit=$(awk "BEGIN { print $pieces < 20 ? 0.001 : 1 }") # at first a piece is one step
    run render kept.mns --size 8x6 -o a.exr --resume -t "$limit" -j $((1 + pieces % 2))
    [ $pieces -gt 0 ] || says err 'going on from a.checkpoint.exr: photons for caustics are still on their way'
    pieces=$((pieces + 1))
done
exits 0
cmp -s whole.exr a.exr || flunk "the pictures differ"
gone a.checkpoint.exr
no_leftovers
end

begin "a time limit holds where photons would take far longer"
kept_scene
sed -i 's/samples = 200/samples = 16000000  caustics = on/' kept.mns
for beside in "--checkpoint 1h" "--sample-range 1..100000 --resume"; do
    begun=$(date +%s)
    # shellcheck disable=SC2086 # two words
    run render kept.mns -o a.exr -t 0.3 $beside
    exits 75
    took=$(($(date +%s) - begun))
    [ $took -le 20 ] || flunk "0.3 s took $took s with $beside"
    there a.checkpoint.exr
    rm -f a.*
done
run_till "$following" INT render kept.mns -o a.exr --checkpoint 1h
exits 130
gone a.exr
says err "the photons so far are kept for '--resume' in a.checkpoint.exr"
end

begin "fewer samples or more noise than the checkpoint's render asks for: it stays, and can be gone on from"
kept_scene
sed -i 's/samples = 200/samples = 600/' kept.mns
run render kept.mns -o whole.exr -q
run_till "$sampling" INT render kept.mns -o a.exr --checkpoint 1h
there a.checkpoint.exr
run render kept.mns -o a.exr --resume --noise 90%
exits 0
says err 'a.checkpoint.exr is there to go on from with --resume'
run info a.checkpoint.exr
matches out '^state: samples +1\.\.600 of 600$'
says_not out 'state: noise'
run render kept.mns -o a.exr --resume -s 1
exits 0
there a.checkpoint.exr
run render kept.mns -o a.exr --resume -q
exits 0
gone a.checkpoint.exr
cmp -s whole.exr a.exr || flunk "the pictures differ"
no_leftovers
end

begin "a time that ends before the first sample: status 75, and no black picture"
kept_scene
sed -i -e 's/samples = 200/samples = 1000000  caustics = on/' kept.mns
echo old > a.exr
run render kept.mns -o a.exr --size 1600x1200 -t 0.01s
[ "$status" = 0 ] || { exits 75; says err "nothing was written"; [ "$(cat a.exr)" = old ] || flunk "a.exr was written"; }
no_leftovers
end

begin "another scene or other settings: what has changed"
kept_scene
run render kept.mns -o a.exr -s 16000000 -t 0.3 --checkpoint 1h -q
exits 75
# changed TEXT ARGUMENT...: the error says TEXT
changed() { wanted=$1; shift; run render -o a.exr -s 16000000 -t 0.3 --resume "$@"; exits 4; says err "$wanted"; says err "cannot go on from 'a.checkpoint.exr'"; }
changed 'seed: 7 in this render, 0 in the checkpoint' kept.mns --seed 7
changed 'size: 20 x 15 in this render, 40 x 30 in the checkpoint' kept.mns --scale 50%
changed 'crop: 0,0,8,8 in this render, none in the checkpoint' kept.mns --crop 0,0,8,8
changed 'AOVs: normal in this render, none in the checkpoint' kept.mns --aov normal
changed 'nesting: entered' kept.mns --nesting entered
changed 'fireflies: keep' kept.mns --fireflies keep
changed 'denoise: on' kept.mns --denoise on
changed 'adaptive: on' kept.mns --adaptive on
changed 'caustics: on' kept.mns --caustics on
changed ': its media (' kept.mns --set glass.ior=1.6
changed ': the objects of the scene (' kept.mns --set lamp.radius=.4
sed 's/albedo = .5/albedo = .6/' kept.mns > other.mns
changed ': its surfaces (' other.mns
sed 's/radius = .3  center = <4/radius = .31  center = <4/' kept.mns > other.mns
changed ': the objects of the scene (' other.mns
sed 's/fov = 30/fov = 31/' kept.mns > other.mns
changed ': its cameras (' other.mns
sed 's/film/environment { color = .1 }\nfilm/' kept.mns > other.mns
changed 'its environment' other.mns
sed 's/film/environment { color = .1  visible = false }\nfilm/' kept.mns > hidden.mns
run render other.mns -o b.exr -s 16000000 -t 0.3 --checkpoint 1h -q
exits 75
run render hidden.mns -o b.exr -s 16000000 -t 0.3 --resume
exits 4
says err 'its environment'
sed 's/sphere ball/\/\/ another text, the same scene\nsphere ball/' kept.mns > other.mns
run render other.mns -o a.exr -s 16000000 -t 0.3 --resume
exits 75
changed 'samples: 1..64 of 16000000 in this render' kept.mns --sample-range 1..64
end

begin "files that are no checkpoints, or not whole"
kept_scene
run render kept.mns -o a.exr -s 16000000 -t 0.3 --checkpoint 1h -q
exits 75
mv a.checkpoint.exr whole.exr
resume() { run render kept.mns -o a.exr -s 16000000 -t 0.3 --resume; }
size=$(wc -c < whole.exr)
for n in 0 3 100 1000 $((size / 2)) $((size - 1)); do
    head -c "$n" whole.exr > a.checkpoint.exr
    resume
    exits 4
    says err "cannot read 'a.checkpoint.exr'"
done
[ "$(grep -c . err)" = 1 ] || flunk "more than one message"
cp a.exr a.checkpoint.exr
resume
exits 4
says err 'it is a picture without the state of a render'
echo text > a.checkpoint.exr
resume
exits 4
says err 'it is not an EXR file'
{ head -c $((size - 2000)) whole.exr; printf damaged; tail -c 1993 whole.exr; } > a.checkpoint.exr
resume
exits 4
says err 'the state of the render in it is damaged'
end

begin "an earlier checkpoint stays where a new one cannot be written"
kept_scene
run render kept.mns -o a.exr -s 16000000 -t 0.3 --checkpoint 1h -q
cp a.checkpoint.exr before.exr
(ulimit -f 20; "$program" render kept.mns -o a.exr -s 16000000 -t 0.5 --resume > out 2> err)
status=$?
exits 5
cmp -s a.checkpoint.exr before.exr || flunk "the checkpoint was touched"
no_leftovers
end

begin "USR1: a snapshot and a checkpoint, and it goes on"
long_scene
"$program" render long.mns -o a.exr --checkpoint 1h -t 300 2> err &
child=$!
await grep -q Progress err
kill -USR1 $child
await grep -qF 'wrote the picture so far' err || flunk "it never says that it wrote the picture so far"
await [ -s a.checkpoint.exr ]
there a.exr
there a.checkpoint.exr
kill -0 $child 2> /dev/null || flunk "it has ended"
cp a.checkpoint.exr early.exr
kill -TERM $child
wait $child
status=$?
exits 143
cmp -s a.checkpoint.exr early.exr && flunk "the checkpoint is the old one"
run info a.checkpoint.exr
exits 0
no_leftovers
end

begin "a checkpoint each so often"
long_scene
"$program" render long.mns -o a.exr --checkpoint 0.2s -t 300 -q 2> err &
child=$!
await [ -s a.checkpoint.exr ]
there a.checkpoint.exr
kill -TERM $child
wait $child
status=$?
exits 143
end

begin "two signals: the second leaves the checkpoint before, and no part of another"
long_scene
run render long.mns --size 1500x1500 -o a.exr --checkpoint 1h -t 0.5 -q
exits 75
cp a.checkpoint.exr before.exr
"$program" render long.mns --size 1500x1500 -o a.exr --resume -t 60 2> err &
child=$!
sleep 1.5
kill -TERM $child
sleep 0.12
kill -TERM $child 2> /dev/null
wait $child 2> /dev/null
status=$?
exits 143
run info a.checkpoint.exr
exits 0
no_leftovers
end

begin "frames: each has its checkpoint; the one that was stopped goes on"
kept_scene
echo 'animation { frames = 2 }' >> kept.mns
run render kept.mns -s 600 -q -o 'whole.#.exr'
exits 0
run_till "$sampling" INT render kept.mns -s 600 -o 'a.#.exr' --resume
exits 130
says err 'of this frame a checkpoint is kept'
run render kept.mns -s 600 -o 'a.#.exr' --resume --skip-existing
exits 0
for i in 1 2; do cmp -s "whole.$i.exr" "a.$i.exr" || flunk "frame $i differs"; done
gone a.1.checkpoint.exr
gone a.2.checkpoint.exr
end
