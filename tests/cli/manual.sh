# manual.sh - help, tables and manual pages agree (that the pages are fresh and well-formed: tests/man.sh).
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

begin "help --json is JSON, and --help and the pages name every option in it"
run help --json
exits 0
is_json out
"$python" - "$program" "$root/man" <<'PYTHON' > problems 2>&1 || flunk "$(cat problems)"
import json, re, subprocess, sys
program, pages = sys.argv[1:]
problems = []
for command in json.load(open("out"))["commands"]:
    name = command["name"]
    full = subprocess.run([program, name, "--help"], capture_output=True, text=True).stdout
    short = subprocess.run([program, name, "-h"], capture_output=True, text=True).stdout
    page = open(f"{pages}/meniscus-{name}.1").read()
    seen = set()
    for option in command["options"]:
        key = option["name"] or option["letter"]
        if key in seen:
            problems.append(f"{name}: {key} twice")
        seen.add(key)
        spelled = f"--{option['name']}" if option["name"] else f"-{option['letter']}"
        for text, where in (full, "--help"), (short, "-h"):
            if not re.search(rf"^ +(-\w, )?{re.escape(spelled)}([ =\[]|$)", text, re.M):
                problems.append(f"{name}: {spelled} is not in {where}")
        if not re.search(rf"^\.It.* Fl {re.escape(spelled[1:])}( |$)", page, re.M):
            problems.append(f"{name}: {spelled} is not in the page")
        for field in "help", "manual", "default", "example":
            if not option[field]:
                problems.append(f"{name}: {spelled} has no {field}")
        if option["help"] and (option["help"].endswith(".") or len(option["help"]) > 80):
            problems.append(f"{name}: the help of {spelled} is long or ends in a full stop")
    letters = [option["letter"] for option in command["options"] if option["letter"]]
    if len(letters) != len(set(letters)):
        problems.append(f"{name}: a letter twice")
    for text in re.findall(r"^\.It Fl -?(\S+)", page, re.M):
        if text not in seen and text not in letters:
            problems.append(f"{name}: the page has {text}, which is no option")
print("\n".join(problems))
sys.exit(bool(problems))
PYTHON
end

begin "the examples of the options are read without complaint"
run help --json
small_scene
"$python" - "$program" <<'PYTHON' > problems 2>&1 || flunk "$(cat problems)"
import json, shlex, subprocess, sys
bad = []
for command in json.load(open("out"))["commands"]:
    for option in command["options"]:
        words = shlex.split(option["example"])
        # -h stops after all has been read up to it: what stands before is checked, nothing is done
        if "--list" in words or "--help" in words:
            continue
        run = subprocess.run([sys.argv[1]] + words[1:] + ["-h"], capture_output=True, text=True)
        if words[0] != "meniscus" or run.returncode != 0:
            bad.append(f"{option['example']}: {run.stderr}")
print("\n".join(bad))
sys.exit(bool(bad))
PYTHON
end

# The scenes in the manual are the blocks that begin with the header.
begin "the scenes in the manual have no mistakes"
"$python" - "$root/man" <<'PYTHON' || flunk "no scenes found"
import glob, re, sys
n = 0
for page in sorted(glob.glob(sys.argv[1] + "/*.[157]")):
    for block in re.findall(r"^\.Bd -literal[^\n]*\n(.*?)^\.Ed", open(page).read(), re.S | re.M):
        lines = [line for line in block.replace("\\-", "-").replace("\\e", "\\").replace("\\(dq", '"').split("\n")
                 if not line.startswith("$ ")]
        if len(lines) > 3 and lines[0].startswith("meniscus 1.0"):
            n += 1
            open(f"manual{n}.mns", "w").write("\n".join(lines))
sys.exit(n == 0)
PYTHON
echo 'meniscus 1.0 unit mm  camera { from = 9 * z  to = <0, 0, 0> }  film { alpha = true  size = <9, 6> }  sphere { surface = surface { } }' > label.mns
run render label.mns -q -s 1 -o label.png
exits 0
for scene in manual*.mns; do
    run check "$scene" --werror
    exits 0
    run render "$scene" --size 16x12 -s 1 -q -o manual.exr
    exits 0
done
end

begin "the message that the manual shows is the one that is printed; every event of --log-format json is named there"
{ echo 'meniscus 1.0 unit mm'; echo 'medium glass { iorr = 1.5 }'; } > glass.mns
run check glass.mns
exits 3
sed -n '/^\.Bd -literal/,/^\.Ed/p;/^\.Ed/q' "$root/man/meniscus-diagnostics.7" | sed -e '/^\./d' -e "s/\\\\(aq/'/g" -e 's/\\//g' > shown
head -n "$(wc -l < shown)" err | cmp -s - shown || flunk "$(cat shown)"
for event in $(sed -n -e 's/.*talk_event[a-z_]*([^"]*"\([a-z]*\)".*/\1/p' -e 's/.*\\"event\\": \\"\([a-z]*\).*/\1/p' "$root"/src/cli/*.c | sort -u); do
    matches "$root/man/meniscus-render.1" "^\.It Li (.* , )?$event( , |\$)"
done
end

begin "every node that other programs have is answered, in scenes and by help"
"$python" - "$program" "$root/src/lang/habit_nodes.def" <<'PYTHON' > problems 2>&1 || flunk "$(cat problems)"
import re, subprocess, sys
program, table = sys.argv[1:]
problems, seen = [], set()
for words, hint in re.findall(r'^HABIT_(?:BLOCK|NODE)\("([^"]*)", "((?:[^"\\]|\\.)*)"\)', open(table).read(), re.M):
    for word in words.split():
        if word in seen:
            problems.append(f"{word}: twice")
        seen.add(word)
        said = subprocess.run([program, "help", word], capture_output=True, text=True)
        if said.returncode and hint.replace('\\"', '"') not in said.stderr:
            problems.append(f"help {word}: {said.stderr}")
        # what is a node here, too, is answered where something foreign stands in it
        scene = f"meniscus 1.0 unit mm\n{word} {{ a = 1 }}\n"
        said = subprocess.run([program, "check", "-"], input=scene, capture_output=True, text=True).stderr
        if "unknown node" in said and "hint: " not in said:
            problems.append(f"{word}: {said}")
print(len(seen), "words", *problems, sep="\n")
sys.exit(bool(problems) or len(seen) < 200)
PYTHON
end
