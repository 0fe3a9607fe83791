# signals.sh - a render that is stopped.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "INT writes the picture and ends by INT"
long_scene
run_till "$sampling" INT render long.mns -o a.exr
exits 130
there a.exr
says err "stopping"
matches err '^wrote a\.exr \(16 x 16, [0-9]+ of 16777216 samples'
no_leftovers
run info a.exr
exits 0
end

begin "TERM and HUP as well"
long_scene
for signal in TERM:143 HUP:129; do
    run_till "$sampling" "${signal%:*}" render long.mns -o "$signal.exr"
    exits "${signal#*:}"
    there "$signal.exr"
done
end

begin "a second signal leaves nothing behind"
long_scene
"$program" render long.mns --size 2048x2048 -o a.exr 2> err &
child=$!
sleep 1
kill -TERM $child
sleep 0.2
kill -TERM $child 2> /dev/null
wait $child 2> /dev/null
status=$?
exits 143
no_leftovers
end

begin "a checkpoint is there before the picture is made, and a second signal leaves it"
long_scene
"$program" render long.mns --size 3000x2000 --denoise on --checkpoint 5m -o a.exr 2> err &
child=$!
await grep -q Progress err
kill -TERM $child
await [ -e a.checkpoint.exr ]
there a.checkpoint.exr
gone a.exr
kill -TERM $child || flunk "it has ended already"
wait $child 2> /dev/null
status=$?
exits 143
gone a.exr
no_leftovers
run info a.checkpoint.exr
exits 0
matches out '^dataWindow +0 0  2999 1999$'
end

begin "an ignored signal stays ignored"
small_scene
(trap '' HUP; "$program" render small.mns -o a.exr -t 1 -s 16777216 2> err & child=$!; sleep 0.4; kill -HUP $child; wait $child)
status=$?
exits 0
there a.exr
end

begin "USR1 while the scene is read is a wish like any other"
small_scene
{ cat small.mns; echo 'var n = 0  while (n < 30000000) { n := n + 1 }'; } > slow.mns
"$program" render slow.mns -o a.exr 2> err &
child=$!
await grep -q '^SigCgt:.*[2367abef]..$' /proc/$child/status # it has said what it does by USR1, the tenth signal
kill -USR1 $child || flunk "it has ended already"
wait $child
status=$?
exits 0
there a.exr
end

begin "TERM while photons are followed: nothing is written but a checkpoint with these"
kept_scene
sed -i -e 's/samples = 200/samples = 1000000  caustics = on/' kept.mns
run_till "$following" TERM render kept.mns -o a.exr --size 640x480 --checkpoint 5m
exits 143
there a.checkpoint.exr
gone a.exr
says err "stopped before the first sample: nothing was written; the photons so far are kept for '--resume' in a.checkpoint.exr"
says_not err "to go on from"
end

begin "TERM before there is a picture: what was promised is taken back, where all is quiet as well"
kept_scene
sed -i -e 's/samples = 200/samples = 1000000  caustics = on/' kept.mns
run_until 3 TERM render kept.mns -o a.exr --size 640x480 -q
exits 143
gone a.exr
says err "stopped before the first sample: nothing was written"
end

begin "checkpoints that cannot be written: the first is told of, and then ever fewer"
kept_scene
sed -i -e 's/samples = 200/samples = 1000000/' kept.mns
mkdir there
"$program" render kept.mns -o there/a.exr --caustics off --checkpoint 1s -t 9s --progress none 2> err &
child=$!
await [ -s there/a.checkpoint.exr ]
mv there elsewhere
wait $child
told=$(grep -c "the render goes on without this checkpoint" err)
[ "$told" -ge 2 ] && [ "$told" -le 4 ] || flunk "it is told of $told times"
says err "as without the 1 before it"
end
