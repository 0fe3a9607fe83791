# progress.sh - the forms of progress, and colours.
# SPDX-License-Identifier: Apache-2.0

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

# on_terminal TERM ARGUMENT...: runs on a pseudo-terminal, all output to the file out
on_terminal() {
    TERM=$1 "$python" - "$program" "$@" <<'PYTHON' > out
import os, pty, sys
program, arguments = sys.argv[1], sys.argv[3:]
child, fd = pty.fork()
if child == 0:
    os.execv(program, [program] + arguments)
data = b""
try:
    while True:
        block = os.read(fd, 65536)
        if not block:
            break
        data += block
except OSError:
    pass
os.waitpid(child, 0)
sys.stdout.buffer.write(data)
PYTHON
}

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
