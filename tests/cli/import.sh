# import.sh - scenes from mesh files, as a person makes them: what is written, that it checks, is laid out and renders, and that
# nothing is lost by it.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

models() { "$python" "$folder/make_models.py" || flunk "no models are made"; }
# is_a_scene SCENE: laid out, and without mistakes and warnings
is_a_scene() {
    run fmt --check "$1"
    exits 0
    run check "$1" --werror
    exits 0
}

begin "import: a drink comes with its glass, its metal, its table, its lights and its camera"
models
run import drink.glb
exits 0
empty out
says err 'wrote drink-Oak_Planks.png and drink.mns: 4 objects, 2 media, 2 surfaces, 3 lights, 1 camera; to see it: meniscus drink.mns'
there drink-Oak_Planks.png
matches drink.mns '^medium glass \{ ior = 1.5  state = solid \}$'
matches drink.mns '^medium whisky \{ ior = 1.36  state = liquid  tint = rgb\(0.85, 0.42, 0.08\)  depth = 12mm \}$'
matches drink.mns '^mesh drink \{ file = model  part = "Drink"  interior = whisky \}$'
matches drink.mns '^mesh ball \{ file = model  part = "Ball"  crease = 40deg  surface = gold \}$'
matches drink.mns '^light lamp \{ shape = sphere  from = <-300, 500, 300>  radius = 10  power = 10 '
matches drink.mns '^camera camera_view \{ from = <0, 170, 380>'
is_a_scene drink.mns
says out 'tumbler overlaps drink'
same_flat drink.mns
run drink.mns -s 4 --scale 10% -o drink.exr
exits 0
there drink.exr
end

begin "import: names that are none, twice the same, and a child below its parent: each object is its own part"
models
run import odd.glb
exits 0
says err "material 'Glass': its colour is taken as that after the mean way"
is_a_scene odd.mns
same_flat odd.mns
matches odd.mns '^mesh glass_object \{ file = model  part = "object:#0"  crease = 40deg  interior = glass \}$'
matches odd.mns '^mesh glass_object_2 \{ file = model  part = "object:#1"  crease = 40deg  interior = glass_2$'
matches odd.mns '^  surface = glass_2_boundary \}$'
matches odd.mns '^mesh object_3 \{ file = model  part = "object:#3"  surface = é \}$'
matches odd.mns '^mesh camera_object \{ file = model  part = "camera"  crease = 40deg  interior = glass \}$'
end

begin "import: whatever a material says"
models
run import kinds.glb
exits 0
says err "material 'Brushed': its iridescence is taken whole, of which the file has 0.5"
matches kinds.mns '^surface brushed .* film = 400nm$'
says err "material 'Dull': one of its pictures is not in the file, and is left out"
says err "object 'open': its mesh is not closed (4 open edges), so nothing can fill it: it is taken as thin"
there kinds-leaf.png
there kinds-ORM.png
there kinds-ORM-2.png # of the same name in the file
gone ../evil
is_a_scene kinds.mns
run kinds.mns -s 2 --scale 10% -o kinds.exr
exits 0
end

begin "import: OBJ files with their materials, STL and PLY files"
models
mkdir maps && cp "$root"/examples/pictures/whisky-slice.png maps/paper.png
run import bottle.obj
exits 0
says err 'the file does not say how long its unit is: a metre is assumed; --unit says otherwise'
says err "material 'paper': its picture 'gone.png' is not there, and is left out"
matches bottle.mns '^medium green_glass \{ ior = 1.52  state = solid  tint = rgb\(0.3333, 1, 0.5\)'
says bottle.mns 'image { file = "maps/paper.png" }'
is_a_scene bottle.mns
run import bottle.obj -o inches.mns --unit 1in
exits 0
says_not err 'is assumed'
says inches.mns 'unit = 25.4mm'
is_a_scene inches.mns
for file in ball.stl open.ply; do
    run import $file
    exits 0
    is_a_scene ${file%.*}.mns
    run ${file%.*}.mns -s 1 --scale 5% -o a.exr
    exits 0
done
says ball.mns 'up = z'
says ball.mns 'It is closed. To make it of glass'
says open.mns 'It has 3 open edges'
end

begin "import: what is there is kept, unless --force is given"
models
run import drink.glb
exits 0
echo '// mine' >> drink.mns
cp drink.mns kept.mns
run import drink.glb
exits 5
says err "'drink.mns' is there already, and may have work of yours in it"
says err "'--force' replaces this one"
cmp -s drink.mns kept.mns || flunk "the scene is another one"
rm drink.mns
run import drink.glb # the picture is there, as it would be written
exits 0
says err 'wrote drink.mns:'
rm drink.mns
echo another > drink-Oak_Planks.png
run import drink.glb
exits 5
says err "'drink-Oak_Planks.png' is there already, and is not the picture of that name in 'drink.glb'"
gone drink.mns
run import drink.glb -f -q
exits 0
empty err
is_a_scene drink.mns
mkdir elsewhere inside
mv drink-Oak_Planks.png elsewhere
ln -s ../elsewhere/drink-Oak_Planks.png inside/drink-Oak_Planks.png
run import drink.glb -f -o inside/drink.mns
exits 5
says err "'inside/drink-Oak_Planks.png' is a link to another folder, where no picture is written"
gone inside/drink.mns
run import drink.glb -o drink.glb --force
exits 2
says err "option '--output': 'drink.glb' must end in .mns"
no_leftovers
end

begin "import: the picture that is rendered is not the one that is read, nor the number of a frame"
models
cp bottle.obj 'a#1 %d.obj'
run import 'a#1 %d.obj'
exits 0
is_a_scene 'a#1 %d.mns'
printf 'newmtl m\nmap_Kd plain.png\n' > plain.mtl
printf 'mtllib plain.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > plain.obj
run import drink.glb -o picture.mns
mv picture-Oak_Planks.png plain.png
run import plain.obj
exits 0
matches plain.mns 'output = \["plain-render.exr", "plain-render.png"\]'
run plain.mns -s 1 --scale 5%
exits 0
there plain-render.png
end

begin "import: names with blanks and quotes, in commands that are told"
models
run import bottle.obj -o "it's one.mns"
exits 0
says err "to see it: meniscus 'it'\\''s one.mns'"
cp bottle.obj 'a bottle.obj'
run info 'a bottle.obj'
says out "meniscus import 'a bottle.obj'"
end

begin "import: to another folder, and to standard output"
models
mkdir -p models scenes/new
mv drink.glb bottle.obj parts.mtl models
run import models/drink.glb -o scenes/new/party.mns
exits 0
there scenes/new/party-Oak_Planks.png
says scenes/new/party.mns '"../../models/drink.glb"'
is_a_scene scenes/new/party.mns
run import models/drink.glb -o nowhere/party.mns
exits 5
says err "there is no folder 'nowhere/'"
mkdir models/maps && cp scenes/new/party-Oak_Planks.png models/maps/paper.png
run import models/bottle.obj
exits 0
says bottle.mns '"models/maps/paper.png"'
is_a_scene bottle.mns
run import models/drink.glb -o -
exits 0
cp out printed.mns
says err 'wrote drink-Oak_Planks.png'
is_a_scene printed.mns
(cd models && "$program" import drink.glb -o - -q | "$program" - -s 1 --scale 5% -q -o a.exr) || flunk "it does not render from a pipe"
there models/a.exr
end

begin "import: floors, axes, and messages for programs"
models
run import ball.stl --floor off -q
says_not ball.mns 'studio.sweep'
says ball.mns 'studio.product_lights'
run import drink.glb --floor on --up y --log-format json
exits 0
says drink.mns 'studio.sweep'
says_not drink.mns 'studio.product_lights'
while read -r line; do printf '%s' "$line" > line; is_json line; done < err
is_a_scene drink.mns
end

begin "import: what is all clear stands on paper, as lamps would light nothing else"
models
run import clear.glb
exits 0
says clear.mns 'studio.sweep'
says clear.mns 'nothing that its lights would fall on'
says_not clear.mns 'studio.product_lights'
is_a_scene clear.mns
run clear.mns -s 16 --size 64x48 -q -o clear.exr
run compare clear.exr clear.exr
mean=$(awk '/^mean of A/ { print $5 * 2 ^ -6 }' out) # the exposure of the scene is -6
awk "BEGIN { exit !($mean > .1) }" || flunk "it is dark: $mean"
run import clear.glb -f --floor off
says_not clear.mns 'studio.sweep'
end

begin "import: a cut gem, by the instructions of its cutter"
cp "$root/examples/assets/brilliant.asc" .
run import brilliant.asc
exits 0
says err "one index of refraction for all colours"
grep -q 'medium stone { ior = 2.417 ' brilliant.mns || flunk "$(cat brilliant.mns)"
run check brilliant.mns --werror --json
exits 0
awk -F'"volume": *' 'NF > 1 { v = $2 + 0 } END { exit !(v > 201.2 && v < 201.3) }' out || flunk "its volume is not that of gems.round_brilliant(): $(cat out)"
is_a_scene brilliant.mns
end

begin "import: one message where it cannot be done"
models
run import
exits 2
run import gone.glb
exits 4
says err "gone.glb"
run import nowhere/gone.glb
exits 4
run import drink.mns
exits 2
says err 'is a scene already'
echo x > picture.png
run import picture.png
exits 4
says err "cannot tell what kind of mesh 'picture.png' is; .ply, .obj, .stl, .gltf, .glb and .asc can be read"
echo x > scene.blend
run import scene.blend
exits 4
says err "no mesh that can be read, as .ply, .obj, .stl, .gltf, .glb and .asc are: Blender exports glTF 2.0 (.glb) of it"
echo x > part.STEP
run import part.STEP
exits 4
says err "FreeCAD and other programs"
head -c 2000 drink.glb > cut.glb
run import cut.glb
exits 4
says err "'cut.glb': it should have"
printf 'v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n' > point.obj
run import point.obj
exits 4
says err "has a size of 0"
run import drink.glb --unit parsec
exits 2
run import drink.glb -o /dev/full
exits 5
gone drink.mns
end

begin "import: hostile files end soon"
"$python" - << 'PYTHON'
import base64, json
n = 20000  # objects of one mesh, each of them its own material
def file(name, nodes, materials, primitives):
    data = "data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/AAIBAAEDAAMCAQID"
    root = {"asset": {"version": "2.0"}, "nodes": nodes, "meshes": [{"primitives": primitives}], "materials": materials,
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
                          {"bufferView": 1, "componentType": 5121, "count": 12, "type": "SCALAR"}],
            "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12}],
            "buffers": [{"byteLength": 60, "uri": data}]}
    json.dump(root, open(name, "w"))
    return root
shape = {"attributes": {"POSITION": 0}, "indices": 1}
file("many.gltf", [{"mesh": 0, "name": "same"} for i in range(n)], [{"name": "m"}] * 3000, [dict(shape, material=i % 3000) for i in range(3)])
file("parts.gltf", [{"mesh": 0, "name": "a" * 300}], [{"name": "m"}] * 900, [dict(shape, material=i) for i in range(900)])
file("names.gltf", [{"mesh": 0}], [{"name": "same"}] * 4000, [dict(shape, material=i) for i in range(4000)])
shared = [{"name": "m%d" % i, "pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(2000)]
root = file("shared.gltf", [{"mesh": 0}], shared, [dict(shape, material=0)])
data = base64.b64encode(b"\x89PNG\r\n\x1a\n" + bytes(4 << 20)).decode()
root["buffers"].append({"byteLength": (4 << 20) + 8, "uri": "data:;base64," + data})
root["bufferViews"].append({"buffer": 1, "byteLength": (4 << 20) + 8})
root.update(textures=[{"source": i} for i in range(2000)], images=[{"bufferView": 2, "mimeType": "image/png"}] * 2000)
json.dump(root, open("shared.gltf", "w"))
file("huge.gltf", [{"mesh": 0, "translation": [1e30, 1e30, 0], "scale": [1e-30, 1e30, 1]}], [], [shape])
PYTHON
for file in many parts names shared huge; do
    (case $program in */asan/* | */hostile/* | */tsan/*) ;; *) ulimit -v 6000000; ulimit -t 60 ;; esac
     exec "$program" import $file.gltf > out 2> err < /dev/null)
    status=$?
    case $status in 0|4) ;; *) flunk "exit status $status of $file.gltf" ;; esac
done
says many.mns 'It has more than 1000 objects: those of one material are one object here.'
for file in many parts; do run fmt --check $file.mns; exits 0; done
end
