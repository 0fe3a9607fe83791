# merge.sh - slices of a render, and the picture that they make.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# slices RANGE...: the files RANGE.exr, with the options in $options
slices() {
    for range; do
        run render kept.mns --sample-range "$range" -o "$range.exr" -q $options
        exits 0
    done
}

begin "parts of a picture are put together"
small_scene
whole='--size 32x24 -s 8 --fireflies keep --denoise off -q --aov normal,samples --half'
# shellcheck disable=SC2086 # words
{
    run render small.mns $whole -o whole.exr
    run render small.mns $whole --crop 0,0,10,24 -o left.exr
    run render small.mns $whole --crop 10,0,32,9 -o top.exr
    run render small.mns $whole --crop 8,9,32,24 -o rest.exr
}
run info left.exr
matches out '^meniscus/crop +0,0,10,24$'
matches out '^dataWindow +0 0  9 23$'
matches out '^displayWindow +0 0  31 23$'
run merge rest.exr left.exr top.exr -o a.exr -o a.png --half
exits 0
says err "wrote a.exr (32 x 24, from 3 parts)"
run compare a.exr whole.exr --max-rmse 0
exits 0
run info whole.exr
grep -v '^meniscus/[nc][or][io]s' out > expected # the noise is not known, and crossings of what is there twice count twice
run info a.exr
grep -v '^meniscus/crossings' out | cmp -s - expected || flunk "the files say other things"
matches out '^meniscus/crossings +[0-9]+$'
run merge left.exr top.exr -o b.exr
exits 75
there b.exr
says err "warning: a part is missing: render it with '--crop 10,9,32,24', and merge again"
run merge left.exr whole.exr -o b.exr
exits 4
says err "'whole.exr' is not a part of a picture by 'render --crop', as 'left.exr' is"
run merge whole.exr left.exr -o b.exr
exits 4
says err "neither a checkpoint nor a slice"
run render small.mns --size 32x24 -s 8 -q --crop 8,9,32,24 -o other.exr
run merge left.exr other.exr -o b.exr
exits 4
says err "they differ in size, or in channels"
sed -i 's/albedo = .5/albedo = .4/' small.mns
# shellcheck disable=SC2086
run render small.mns $whole --crop 8,9,32,24 -o other.exr
run merge left.exr other.exr -o b.exr
exits 4
says err "'left.exr' and 'other.exr' are not of one picture, as there differs: meniscus/sceneHash"
end

begin "slices of any kind, in any order: the picture of one render, byte for byte"
kept_scene
options='--aov all'
run render kept.mns $options -o whole.exr -q
slices 1..3 4..64 65..130 131..200
run merge -o merged.exr 131..200.exr 4..64.exr 1..3.exr 65..130.exr
exits 0
says err 'wrote merged.exr (40 x 30, 200 of 200 samples, from 4 slices)'
cmp -s whole.exr merged.exr || flunk "the pictures differ"
slices 1..1 2..200
run merge -o merged.exr -o merged.png 1..1.exr 2..200.exr -j 1
exits 0
cmp -s whole.exr merged.exr || flunk "the pictures of two slices differ"
run render kept.mns $options -o whole.png -q
cmp -s whole.png merged.png || flunk "the PNG pictures differ"
run merge -q -o merged.exr 1..1.exr 2..200.exr
exits 0
empty err
run merge -o merged.exr 1..1.exr - < 2..200.exr
exits 2
says err "slices are read twice, and standard input only once; give files"
run merge -o - 1..1.exr 2..200.exr
cmp -s out whole.exr || flunk "standard output differs"
run view 4..64.exr -o slice.png
exits 0
run info 4..64.exr
exits 0
matches out '^state: samples +4\.\.64 of 200$'
options='--crop 8,8,30,23 --half --denoise on'
run render kept.mns $options -o whole.exr -q
slices 1..100 101..200
run merge --half -o merged.exr 1..100.exr 101..200.exr
cmp -s whole.exr merged.exr || flunk "the cropped, denoised pictures differ"
run info merged.exr
says out "meniscus/denoised"
no_leftovers
end

begin "gaps are said, and what fills them; overlaps are refused"
kept_scene
options='-s 100'
slices 1..10 21..50 41..90
run merge -o merged.exr 1..10.exr 21..50.exr
exits 75
says err "the samples 11..20 of 100 are missing: render them with '--sample-range 11..20'"
says err "the samples 51..100 of 100 are missing"
there merged.exr
rm merged.exr
run merge -o merged.exr 1..10.exr 41..90.exr 21..50.exr
exits 4
says err "'21..50.exr' and '41..90.exr' both hold the samples 41..50"
gone merged.exr
run merge -o merged.exr 1..10.exr 1..10.exr
exits 4
says err 'both hold the samples 1..10'
end

begin "slices of other renders: what differs"
kept_scene
options='-s 100'
slices 1..50
run render kept.mns -s 100 --sample-range 51..100 --seed 3 -o seed.exr -q
run merge -o merged.exr 1..50.exr seed.exr
exits 4
says err 'seed: 0 in 1..50.exr, 3 in seed.exr'
run render kept.mns -s 200 --sample-range 51..100 -o total.exr -q
run merge -o merged.exr 1..50.exr total.exr
exits 4
says err 'samples of the whole: 100 in 1..50.exr, 200 in total.exr'
run render kept.mns -s 100 --sample-range 51..100 --set glass.ior=1.6 -o glass.exr -q
run merge -o merged.exr 1..50.exr glass.exr
exits 4
says err 'there differs: its media'
run render kept.mns -s 4 -o picture.exr -q
run merge -o merged.exr 1..50.exr picture.exr
exits 4
says err 'without the state of a render'
head -c 5000 1..50.exr > cut.exr
run merge -o merged.exr cut.exr
exits 4
says err "cannot read 'cut.exr'"
run merge 1..50.exr
exits 2
run merge -o 1..50.exr 1..50.exr
exits 2
says err 'both an input and the output'
gone merged.exr
end

begin "a slice that was stopped goes on, from its own file or a checkpoint"
kept_scene
run render kept.mns -s 600 -o whole.exr -q
exits 0
for seconds in 0.3 1 3 9; do # on a loaded machine the first may end before a sample does
    run render kept.mns -s 600 --sample-range 301..600 -o b.exr -t $seconds -q
    [ $status -eq 75 ] || break
done
exits 0
run merge -o merged.exr b.exr
exits 4
says err "render it to its end, with '--sample-range 301..600 --resume'"
run render kept.mns -s 600 --sample-range 301..600 -o b.exr --resume
exits 0
says err 'going on from b.exr'
run render kept.mns -s 600 --sample-range 1..300 -o a.exr --checkpoint 1h -t 0.3
exits 75
run render kept.mns -s 600 --sample-range 1..300 -o a.exr --resume
exits 0
gone a.checkpoint.exr
run merge -o merged.exr a.exr b.exr
exits 0
cmp -s whole.exr merged.exr || flunk "the pictures differ"
end

begin "ranges that there are not"
kept_scene
for wrong in 0..4 5..4 5 a..b 1..2..3 1..; do
    run render kept.mns --sample-range $wrong
    exits 2
done
run render kept.mns --sample-range 100..201
exits 2
says err 'sample 201 is beyond the 200'
run render kept.mns --sample-range 1..10 -o a.png
exits 2
says err 'name one with'
run render kept.mns --sample-range 1..10 --noise 1%
exits 2
says err "'--noise 0'"
run render kept.mns --sample-range 1..10 --adaptive on
exits 2
says err "'--adaptive off'"
end
