# volumes.sh - grids of files, and media that vary, shine and mix, as a user meets them.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

smoke_scene() {
    cp "$root/tests/unit/voxels.nvdb" .
    cat > smoke.mns << 'END'
meniscus 1.0 unit m
param name = "density"
param factor = 1
medium water { ior = 1.33  state = liquid }
medium smoke {
  mixes = true  scattering = 3  emission = blackbody(1800K)  radiance = .5
  density = volume { file = "voxels.nvdb"  grid = name  scale = factor  translate(<-11.5, -22.75, -34.25>) }
}
box smoking { interior = smoke  size = <8, 5, 6> }
sphere drop { interior = water  radius = .5  center = <1, 0, 0> }
camera { from = <0, 0, 12>  to = <0, 0, 0>  fov = 40 }
environment { color = .2 }
film { size = <24, 18> }
render { samples = 4 }
END
}

begin "a grid of a file renders, the same for any number of threads"
smoke_scene
run render smoke.mns -o one.exr -j 1
exits 0
run render smoke.mns -o two.exr -j 3
exits 0
cmp -s one.exr two.exr || flunk "the pictures differ"
run render smoke.mns -D factor=0 -o clear.exr
exits 0
says err "this density is 0 everywhere"
run compare one.exr clear.exr --max-rmse 0.01
exits 1
end

begin "the hash of a scene knows its grids"
smoke_scene
for change in 'name="density"' 'name="fp8"' 'factor=2'; do scene_hash smoke.mns -D "$change"; done | sort -u > hashes
[ "$(wc -l < hashes)" -eq 3 ] || flunk "grids with one hash"
end

begin "dump --flat: a grid of a file keeps its place"
smoke_scene
same_flat smoke.mns
end

begin "check: what mixes adds up, and is not in what it is not in"
smoke_scene
run check smoke.mns
exits 0
matches out '^  smoke +mixes +.*scatters every 333 mm, shines, by a density up to 0.672'
says out "drop inside smoking: there is no smoke in water"
run check --pixel 12,9 smoke.mns
exits 0
matches out 'smoking +entered in silence: it adds to air'
run check --json smoke.mns
exits 0
is_json out
says out '"decided": "mix"'
end

begin "grids stay within the folder of --confine, and are found as other files are"
smoke_scene
mkdir inner
sed 's/"voxels.nvdb"/"..\/voxels.nvdb"/' smoke.mns > inner/smoke.mns
run check inner/smoke.mns
exits 0
run check --confine inner inner/smoke.mns
exits 3
says err "[outside-confine]"
rm voxels.nvdb
run check smoke.mns
exits 3
says err "no file 'voxels.nvdb' [file-not-found]"
end

begin "a grid larger than memory, and a file that is none"
smoke_scene
"$python" - << 'END'
data = bytearray(open("voxels.nvdb", "rb").read())
data[12:14] = (1).to_bytes(2, "little")          # one grid,
data[16:24] = (1 << 50).to_bytes(8, "little")    # of a million gigabytes
open("voxels.nvdb", "wb").write(data)
END
run check smoke.mns
exits 3
says err "[volume-invalid]"
head -c 100 /dev/zero > voxels.nvdb
run check smoke.mns
exits 3
says err "'voxels.nvdb' is no NanoVDB file [volume-invalid]"
end

begin "info: the grids of a file"
smoke_scene
run info voxels.nvdb
exits 0
matches out '^grid +density$'
matches out '^spans voxels +12 x 6 x 8$'
matches out '^size of a voxel +0.5$'
[ "$(grep -c '^can be a volume  *yes$' out)" -eq 6 ] || flunk "not six that can be volumes"
run info --json voxels.nvdb
is_json out
says out '"name": "fp16"'
head -c 300 voxels.nvdb > cut.nvdb
run info cut.nvdb
exits 4
says err "'cut.nvdb' is broken: it ends within"
: > empty.nvdb
run info empty.nvdb
exits 4
says err "'empty.nvdb' holds no grids"
empty out
run info --json empty.nvdb
exits 4
empty out
end
