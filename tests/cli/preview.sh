# preview.sh - pictures so far in files, in the terminal and in tev, and scenes that are rendered anew when they change.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "a preview is written while the picture grows, which is the same as without"
small_scene
run render small.mns -o a.exr --size 33x22 --spp 9
run render small.mns -o b.exr --size 33x22 --spp 9 --preview now.png
exits 0
[ "$(head -c 4 now.png | od -An -tx1 | tr -d ' ')" = 89504e47 ] || flunk "now.png is no PNG file"
cmp -s a.exr b.exr || flunk "another picture with a preview"
run render small.mns -o b.exr --size 33x22 --spp 40 --noise 5% --preview now.exr
exits 0
run compare now.exr b.exr --max-rmse 0.002
exits 0
no_leftovers
run render small.mns -o b.exr --preview b.exr
exits 2
matches err "'b.exr' is both an output and the preview"
run render small.mns -o b.exr --preview -
exits 2
matches err 'needs a file, not standard output'
run render small.mns -o b.exr --preview now.jpg
exits 2
matches err 'must end in .exr or .png'
run render small.mns -o b.exr --preview nowhere/now.png
exits 5
end

begin "a preview in the terminal is drawn in place, and only where there is one"
small_scene
run render small.mns -o a.exr --spp 9
on_terminal xterm-256color render small.mns -o b.exr --spp 9 --preview term
cmp -s a.exr b.exr || flunk "another picture with a preview"
up=$(printf '\033[22A') # a picture of 22 of the 24 lines goes up by as many before the next one
says out "$up"
says out "$(printf '\033[38;')"
says out 'wrote b.exr'
on_terminal xterm render small.mns -o b.exr --preview term:sixel
says out "$(printf '\033P')"
run render small.mns -o c.exr --spp 9 --aov depth
on_terminal xterm-256color view c.exr --layer depth --preview term
says out "$(printf '\033[38;')"
on_terminal xterm render small.mns -o b.exr --preview term:ascii
says out "no graphics 'ascii' of terminals; symbols, sixel, kitty and iterm2 are known"
rm b.exr
run render small.mns -o b.exr --preview term
exits 2
says err "and there is none that can"
gone b.exr
end

begin "view shows a picture in the terminal"
small_scene
run render small.mns -o a.exr
on_terminal xterm-256color view a.exr --preview term --exposure -1
says out "$(printf '\033[38;')"
run view a.exr --preview term
exits 2
run view a.exr --preview a.png
exits 2
says err "'-o a.png' writes a file"
end

begin "a preview in tev, which has to run"
small_scene
cat > listen.py <<'PYTHON'
import socket, sys
server = socket.socket()
server.bind(("127.0.0.1", 0))
server.listen(1)
print(server.getsockname()[1], flush=True)
connection, _ = server.accept()
data = b""
while block := connection.recv(65536):
    data += block
packets = []
while data:
    length = int.from_bytes(data[:4], "little")
    packets.append(data[4:length])
    data = data[length:]
kinds = [packet[0] for packet in packets]
assert kinds[0] == 4 and len(kinds) > 1 and set(kinds[1:]) == {6}, kinds
assert all(packet[2:].startswith(b"small.mns\0") for packet in packets)
PYTHON
"$python" listen.py > port 2> heard &
listening=$!
await [ -s port ]
port=$(cat port)
run render small.mns -o a.exr --preview "tev:127.0.0.1:$port"
exits 0
wait "$listening" || flunk "tev would not understand: $(cat heard)"
run render small.mns -o b.exr --preview "tev:localhost:$port"
exits 5
says err "no tev takes pictures at localhost:$port"
gone b.exr
end

# until_says FILE TEXT: waits for it; the file, too, may still be to come
until_says() { await grep -qF -e "$2" "$1" || flunk "$1 never says: $2"; }
differ() { ! cmp -s "$1" "$2"; }

begin "a scene is rendered anew whenever one of its files changes"
small_scene
printf 'meniscus 1.0 unit cm\nlet blue = rgb(.1, .2, .8)\n' > colors.mns
sed -e '/^meniscus/a use "colors.mns" as colors' -e 's/albedo = .5/albedo = colors.blue/' small.mns > watched.mns
timeout 300 "$program" watched.mns --watch -o a.exr > out 2> err &
watching=$!
until_says err "watching 'watched.mns' and 1 file that it reads"
cp a.exr first.exr
printf 'meniscus 1.0 unit cm\nlet blue = rgb(.8, .2, .1)\n' > colors.mns
until_says err "'colors.mns' has changed"
await differ a.exr first.exr || flunk "the picture is not a new one"
echo 'sphere { raduis = 1 }' >> watched.mns
until_says err "did you mean 'radius'?"
sed -i -e '/raduis/d' watched.mns
echo 'mesh { file = "late.ply"  interior = glass }' >> watched.mns
until_says err "no file 'late.ply'"
cat > late.ply <<'PLY'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 3
PLY
until_says err "'late.ply' has changed"
until_says err "watching 'watched.mns' and 2 files that it reads"
[ "$(grep -c '^wrote a.exr' err)" -eq 3 ] || flunk "not three pictures"
sed -i -e 's/^environment.*/environment { image = "sky.exr" }/' watched.mns
until_says err "no file 'sky.exr'"
cp first.exr sky.exr
until_says err "watching 'watched.mns' and 3 files that it reads"
cp a.exr new.exr
mv new.exr sky.exr
until_says err "'sky.exr' has changed"
kill "$watching" # by TERM: a shell's background processes ignore INT
wait "$watching" 2> /dev/null
[ $? -eq 143 ] || flunk "it did not end by the signal"
no_leftovers
end

begin "a render that goes on is given up when its scene changes"
long_scene
timeout 300 "$program" long.mns --watch -o a.exr --progress json > out 2> err &
watching=$!
until_says err '"event": "progress"'
sed -i -e 's/samples = 16777216/samples = 4/' long.mns
until_says err "'long.mns' has changed"
until_says err "watching 'long.mns'"
[ "$(grep -c '^wrote' err)" -eq 1 ] || flunk "not one picture"
there a.exr
kill "$watching"
wait "$watching" 2> /dev/null
end

begin "what cannot be watched is refused"
small_scene
run render - --watch -o a.exr
exits 2
says err "needs a scene that can change"
run render small.mns --watch -o -
exits 2
says err "with '--watch' there are many"
run render small.mns --watch --resume
exits 2
says err "'--resume' is about one that does not"
run render nothing.mns --watch
exits 4
end
