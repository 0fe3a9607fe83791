# meshes.sh - mesh files at their worst: what is wrong is said, and nothing crashes.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

tetrahedron() { # tetrahedron SIZE: as OBJ, on standard output
    printf 'v 0 0 0\nv %s 0 0\nv 0 %s 0\nv 0 0 %s\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' "$1" "$1" "$1"
}
# mesh_scene MESH...: a small scene of glass meshes, each given by its properties
mesh_scene() {
    echo 'meniscus 1.0 unit cm
medium glass { ior = 1.5  tint = rgb(.9, .5, .2)  depth = 1cm }
environment { }
camera { from = <1, 2, 8>  to = <.3, .3, .3>  fov = 20 }
film { size = <16, 12> }
render { samples = 4 }'
    for mesh; do echo "mesh { interior = glass  $mesh }"; done
}
refuses_mesh() { # refuses_mesh FILE TEXT
    mesh_scene "file = \"$1\"" > scene.mns
    run render scene.mns
    exits 3
    says err "$2"
    gone scene.exr
}

begin "meshes: damaged files name the file and the place"
: > empty.ply
refuses_mesh empty.ply "'empty.ply' is not a PLY file"
printf 'v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n' > nan.obj
refuses_mesh nan.obj "'nan.obj':3: 'nan' stands where a number should be"
printf 'v 0 0 0\nv 1e60 0 0\nv 0 1 0\nf 1 2 3\n' > far.obj
refuses_mesh far.obj "'far.obj':2: the number 1e+60 is too large"
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n' > index.obj
refuses_mesh index.obj "'index.obj':4: a face uses position 7; there are 3"
printf '# nothing\n' > nothing.obj
refuses_mesh nothing.obj "'nothing.obj' has no faces"
printf 'solid and then nothing that a text or a binary STL file could be, for more than eighty-four bytes' > lie.stl
refuses_mesh lie.stl "'lie.stl' "
printf '{"asset": {"version": "2.0"}, "extensionsRequired": ["KHR_draco_mesh_compression"]}' > packed.gltf
refuses_mesh packed.gltf "KHR_draco_mesh_compression"
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 1 2\nf 3 3 3\n' > flat.obj
refuses_mesh flat.obj "the mesh has no triangles"
tetrahedron 1 | sed 's/f 1 3 2//' > open.obj
refuses_mesh open.obj "is open and encloses nothing: 3 edges have a face on one side only"
end

begin "meshes: seams that are open by rounding close, others as 'weld' says"
torn() { # torn GAP: a tetrahedron whose first face has corners of its own, one of them off by that
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 %s\nv 1 0 0\nv 0 1 0\nf 5 7 6\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' "$1"
}
torn -1e-7 > seam.obj
mesh_scene 'file = "seam.obj"' > scene.mns
run check scene.mns
exits 0
says err "remark: the mesh of mesh 1 was open by 1.00 nm or less: 1 of its vertices is joined to others [mesh-joined]"
run render scene.mns
exits 0
says_not err mesh-joined
run info seam.obj
matches out 'closed  *yes'
matches out 'vertices joined to close it  *1$'
mesh_scene 'file = "seam.obj"  weld = 0' > scene.mns
refuses_mesh_of() { run check scene.mns; exits 3; says err "is open and encloses nothing"; }
refuses_mesh_of
says err "hint: vertices on these edges lie 1 nm apart or less: weld = 2nm closes it"
torn -3e-4 > seam.obj
mesh_scene 'file = "seam.obj"' > scene.mns
refuses_mesh_of
says err "hint: vertices on these edges lie 3 um apart or less: weld = 4um closes it"
mesh_scene 'file = "seam.obj"  weld = 4um' 'file = "seam.obj"  weld = 40um  unit = 10cm  scale(.1)' > scene.mns
run check scene.mns
exits 0
says_not err mesh-joined
mesh_scene 'file = "seam.obj"  weld = 4um  unit = 10cm' > scene.mns
refuses_mesh_of
says err "weld = 40um closes it"
end

begin "meshes: a pole that is many places by rounding closes"
awk 'BEGIN { pi = atan2(0, -1); n = 32
    for (i = 0; i <= 8; i++) for (k = 0; k < n; k++) { r = sin(pi * i / 8); t = 2 * pi * k / n
        printf "v %.17g %.17g %.17g\n", r * cos(t), cos(pi * i / 8), -r * sin(t) }
    for (i = 0; i < 8; i++) for (k = 0; k < n; k++) { l = (k + 1) % n
        print "f", i * n + k + 1, (i + 1) * n + k + 1, (i + 1) * n + l + 1, i * n + l + 1 } }' > pole.obj
mesh_scene 'file = "pole.obj"' > scene.mns
run check scene.mns
exits 0
says err "64 of the triangles of the mesh have no extent and are dropped"
matches err "the mesh of mesh 1 was open by .* nm or less: 31 of its vertices are joined to others \[mesh-joined\]"
run render scene.mns
exits 0
says err " 0 nesting faults"
mesh_scene 'file = "pole.obj"  weld = 0' > scene.mns
refuses_mesh_of
says err "weld = 0.04nm closes it"
end

begin "meshes: what is dropped, and edges of several faces, are reported with places"
{ tetrahedron 1; printf 'f 4 2 3\nf 3 3 4\n'; } > extra.obj
mesh_scene 'file = "extra.obj"' > scene.mns
run check scene.mns
exits 0
says err "1 of the triangles of the mesh has no extent and is dropped"
says err "it is at <0, 1, 0>"
says err "1 of the triangles of the mesh occurs twice; one is dropped"
{ tetrahedron 1; printf 'v 1 1 1\nf 2 5 3\nf 2 3 5\nf 2 4 5\n'; } > fins.obj
refuses_mesh fins.obj "more than two faces"
matches err 'note: edge of several faces from <'
end

begin "meshes: transforms that flatten are refused, mirrored ones make the same picture"
tetrahedron 1 > t.obj
mesh_scene 'file = "t.obj"  scale(<1, 0, 1>)' > scene.mns
run render scene.mns
exits 3
says err "[singular-transform]"
tetrahedron -1 > m.obj
mesh_scene 'file = "t.obj"' > plain.mns
mesh_scene 'file = "m.obj"  scale(-1)' > mirrored.mns
run render plain.mns
exits 0
run render mirrored.mns
exits 0
run compare plain.exr mirrored.exr --max-rmse 0.01
exits 0
end

begin "meshes: one a billion times larger than another"
tetrahedron 1 > t.obj
mesh_scene 'file = "t.obj"' 'file = "t.obj"  scale(1e9)  translate(<-1e8, -1e8, -1e8>)' > scene.mns
run render scene.mns
exits 0
there scene.exr
mesh_scene 'file = "t.obj"' 'file = "t.obj"  scale(1e18)' > scene.mns
run render scene.mns
exits 3
says err "[value-out-of-range]"
end

begin "meshes: parts that overlap are one body, and info counts faces that cross"
{ tetrahedron 1; printf 'v .2 .2 .2\nv 2 .2 .2\nv .2 2 .2\nv .2 .2 2\nf 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n'; } > two.obj
mesh_scene 'file = "two.obj"' > scene.mns
run check scene.mns
exits 0
says err "[mesh-parts-overlap]"
says err "the 2 parts of the mesh of mesh 1 overlap: they are one body"
run render scene.mns
exits 0
says err " 0 nesting faults"
run info two.obj
exits 0
matches out '^faces that cross +3$'
matches out '^pieces that overlap +2$'
matches out '^pieces within pieces +0$'
end

begin "meshes: a part within another that faces outward is told of, in renders, too"
{ tetrahedron 1; tetrahedron .5 | sed -n 's/^v \([^ ]*\) \([^ ]*\) \([^ ]*\)/v \1.1 \2.1 \3.1/p; s/\.5\.1/.3/g' | sed 's/\.5\.1/.3/g'; printf 'f 5 7 6\nf 5 6 8\nf 5 8 7\nf 6 7 8\n'; } > shell.obj
mesh_scene 'file = "shell.obj"' > scene.mns
for command in check render; do
    run "$command" scene.mns
    exits 0
    says err "1 part of the mesh of mesh 1 lies within another and adds nothing"
    says err "[mesh-part-within]"
    [ "$(grep -c mesh-part-within err)" = 1 ] || flunk "it is told of several times"
done
sed 's/f 5 7 6/f 5 6 7/; s/f 5 6 8/f 5 8 6/; s/f 5 8 7/f 5 7 8/; s/f 6 7 8/f 6 8 7/' shell.obj > hollow.obj
mesh_scene 'file = "hollow.obj"' > scene.mns
run render scene.mns
exits 0
says_not err mesh-part-within
end

begin "meshes: parts, units, and what has no effect without a file"
{ echo 'o one'; tetrahedron 1; echo 'o two'; tetrahedron 2 | sed '/^f/d'; printf 'f -4 -2 -3\nf -4 -3 -1\nf -4 -1 -2\nf -3 -2 -1\n'; } > two.obj
run info two.obj
exits 0
matches out "^object +'two', 4 triangles$"
mesh_scene 'file = "two.obj"  part = "two"  unit = 1mm' > scene.mns
run check scene.mns
exits 0
says out "1.33 mm³"
mesh_scene 'positions = [<0, 0, 0>, <1, 0, 0>, <0, 1, 0>, <0, 0, 1>]  triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>, <1, 2, 3>]  up = z' > scene.mns
run check scene.mns
exits 3
says err "'up'"
end

begin "the size that a sweep's outline is said to have room for fits, and a larger one does not"
cat > folds.mns <<'SCENE'
meniscus 1.0 unit mm
param which = 0
param size = 1
let gold = surface { metal = gold }
// a bend, a path with a place that turns nearly on the spot, a corner, a twisted loop, radii of its own
let square = [<-1, -1>, <1, -1>, <1, 1>, <-1, 1>]
let round = [for (i in 0..35) <cos(10 * i), sin(10 * i)>]
if (which == 0) { sweep { path = [<0, 0, 0>, <2, 2, 0>, <2.6, 5, 0>, <2.1, 5.6, 0>]  outline = round  radius = size  surface = gold } }
if (which == 1) { sweep { path = [for (i in 0..40) 3 * <rnd(i, 1), rnd(i, 2), rnd(i, 3)> + i * x]  outline = round  radius = size  surface = gold } }
if (which == 2) { sweep { path = [<0, 0, 0>, <5, 0, 0>, <5, 1, 0>]  curve = linear  outline = square  radius = size * 2  surface = gold } }
let ring = [for (i in 0..11) <cos(30 * i), .1 * sin(90 * i), sin(30 * i)>]
if (which == 3) { sweep { path = ring  closed = true  twist = 360  outline = square  radius = size * 2  surface = gold } }
if (which == 4) { sweep { path = [<0, 0, 0>, <4, 0, 0>, <4, 3, 0>, <0, 3, 1>]  outline = round  radius = [1, 4 * size, 4 * size, 2]  surface = gold } }
environment { }
camera { from = <0, 0, 50>  to = <0, 0, 0> }
SCENE
for which in 0 1 2 3 4; do
    run check folds.mns -D which=$which
    exits 3
    matches err 'hint: [0-9.]+ times the size, which fits all along the path'
    fits=$(sed -nE 's/.*hint: ([0-9.e-]+) times.*/\1/p' err)
    run check folds.mns -D which=$which -D size="$fits"
    says_not err 'folds over itself'
    [ $which = 4 ] && continue # where some radii stay as they are
    exits 0
    run check folds.mns -D which=$which -D size="$(awk "BEGIN { print 1.15 * $fits }")"
    says err 'folds over itself'
done
end

begin "meshes: 'crease' shades smoothly what has no normals, in file and in place"
tetrahedron 1 > t.obj
places='positions = [<0, 0, 0>, <1, 0, 0>, <0, 1, 0>, <0, 0, 1>]  triangles = [<0, 2, 1>, <0, 1, 3>, <0, 3, 2>, <1, 2, 3>]'
n=0
for mesh in 'file = "t.obj"' 'file = "t.obj"  crease = 50deg' 'file = "t.obj"  crease = 130deg' "$places  crease = 130deg"; do
    n=$((n + 1))
    mesh_scene "$mesh" > "$n.mns"
    run render "$n.mns" -o "$n.exr"
    exits 0
    says err " 0 nesting faults"
done
run compare 1.exr 2.exr --max-rmse 0
exits 0
run compare 1.exr 3.exr --max-rmse .01
exits 1
run compare 3.exr 4.exr --max-rmse 0
exits 0
mesh_scene 'file = "t.obj"' 'file = "t.obj"  crease = 130deg  translate(<3, 0, 0>)' > scene.mns
run render scene.mns -o both.exr
run compare 1.exr both.exr --max-rmse 0
exits 0
end

begin "meshes: normals that point inward are turned, with the triangles or alone, also of a mesh that deforms"
ball_file() { # ball_file FILE NORMALS TURN RADIUS: NORMALS 1: outward, -1: inward; TURN 1: the triangles look inward
    awk -v side="$2" -v turn="$3" -v radius="$4" 'BEGIN {
        n = 12; pi = atan2(0, -1)
        for (i = 0; i <= n; i++) for (k = 0; k < 2 * n; k++) {
            a = pi * i / n; b = pi * k / n
            x = sin(a) * cos(b); y = cos(a); z = sin(a) * sin(b)
            print "v", radius * x, radius * y, radius * z "\nvn", side * x, side * y, side * z
        }
        for (i = 0; i < n; i++) for (k = 0; k < 2 * n; k++) {
            p = 2 * n * i + k + 1; q = 2 * n * i + (k + 1) % (2 * n) + 1; r = p + 2 * n; s = q + 2 * n
            if (i) printf turn ? "f %d//%d %d//%d %d//%d\n" : "f %d//%d %d//%d %d//%d\n", p, p, turn ? r : q, turn ? r : q, turn ? q : r, turn ? q : r
            if (i < n - 1) printf "f %d//%d %d//%d %d//%d\n", q, q, turn ? r : s, turn ? r : s, turn ? s : r, turn ? s : r
        }
    }' > "$1"
}
ball_scene() { # ball_scene FILE NEXT
    echo "meniscus 1.0 unit cm
camera { from = <1, 2, 8>  to = <0, 0, 0>  fov = 22 ${2:+ shutter = 360} }
light { shape = distant  from = <1, 2, 1>  to = <0, 0, 0>  radiance = 3000 }
film { size = <40, 30> }
render { samples = 16 }
mesh { surface = surface { ior = 1.5  roughness = .3 }  file = \"$1\" ${2:+next_file = \"$2\"} }" > ball.mns
    [ -z "${2-}" ] || echo 'animation { frames = 2 }' >> ball.mns
}
ball_file right.obj 1 0 1
ball_file inward.obj -1 0 1
ball_file inside-out.obj -1 1 1
ball_file grown.obj 1 0 1.2
ball_file inside-out-grown.obj -1 1 1.2
ball_scene right.obj && run render ball.mns -o right.exr -q
exits 0
ball_scene inward.obj && run render ball.mns -o inward.exr
exits 0
says err "warning: the normals of the mesh pointed to the inner side of its triangles; they are turned [mesh-mended]"
run compare right.exr inward.exr --max-rmse 1e-5
exits 0
ball_scene inside-out.obj && run render ball.mns -o inside-out.exr
says err "the mesh was inside out; all of its triangles are turned"
says_not err "the normals"
run compare right.exr inside-out.exr --max-rmse 1e-5
exits 0
ball_scene right.obj grown.obj && run render ball.mns --frame 1 -o growing.exr -q
exits 0
ball_scene inside-out.obj inside-out-grown.obj && run render ball.mns --frame 1 -o growing-too.exr -q
run compare growing.0001.exr growing-too.0001.exr --max-rmse 1e-5
exits 0
end

begin "a texture by where a surface faces: on a smooth mesh of a ball as on the ball"
for shape in "sphere { radius = 1" "isosurface { function = ball  from = vec3(-1.1)  to = vec3(1.1)"; do
    cat > "${shape%% *}.mns" << SCENE
meniscus 1.0 unit cm
def ball(x, y, z) = x * x + y * y + z * z - 1
def bands(p, normal) = frac(8 * normal.y) < .5 ? .1 : .8
$shape  surface = surface { albedo = bands } }
environment { color = 1 }
camera { from = <0, 1, 10>  to = <0, 0, 0>  fov = 13 }
film { size = <64, 64> }
render { samples = 64 }
SCENE
    run render "${shape%% *}.mns" -o "${shape%% *}.exr" -q
    exits 0
done
run compare isosurface.exr sphere.exr --max-rmse 0.035 # the edges of bands; 0.051 with a normal for each triangle
exits 0
end

begin "info: names of a file's parts are shown, and do nothing to the terminal"
{ printf 'g r\033[31mot\342\200\256\303\237 \342\230\203\n'; tetrahedron 1; } > names.obj
run info names.obj
exits 0
says out "'r?[31mot?ß ☃', 4 triangles"
run info --json names.obj
exits 0
is_json out
end

begin "meshes: files that have a unit of their own can be asked for their shape, in scenes of any unit"
cp "$root/examples/assets/brilliant.asc" stone.asc # half of its width is 5 mm
for unit in mm cm; do
    cat > asked.mns << SCENE
meniscus 1.0 unit $unit
use "std/studio.mns" as studio
let stone = mesh { file = "stone.asc"  interior = medium { ior = 2.4  state = solid } }
assert(abs(bounds(stone).max.x - 5mm) < .01mm, bounds(stone).max)
assert(bounds(group { stone { translate(9mm * x) } }).max.x > 13.9mm and volume(stone) > 100mm * 1mm * 1mm)
studio.gem_shot(10mm) { stone { } }
SCENE
    run check asked.mns --werror
    exits 0
done
end
