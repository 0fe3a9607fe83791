#!/bin/sh
# The files for editors and fuzzing are well formed, and find what is what. (tests/man.sh: they are fresh.)
# usage: tests/editor.sh MENISCUS
# SPDX-License-Identifier: Apache-2.0
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
program=$1
scratch=$(mktemp -d) || exit 2
trap 'rm -rf "$scratch"' EXIT
n_passed=0 n_failed=0
result() { # STATUS NAME
    if [ "$1" -eq 0 ]; then n_passed=$((n_passed + 1)); else
        n_failed=$((n_failed + 1))
        echo "not ok - $2"
    fi
}

"${PYTHON:-python3}" - "$root/grammar" "$program" <<'PYTHON'
import json, re, subprocess, sys
folder, program = sys.argv[1:]
grammar = json.load(open(f"{folder}/meniscus.tmLanguage.json"))
words = []
for pattern in grammar["patterns"] + grammar["repository"]["comment"]["patterns"]:
    for key in "match", "begin", "end":
        if key in pattern:
            words.append((pattern.get("name", ""), re.compile(pattern[key])))
find = lambda name, text: [m.group() for n, r in words if n.startswith(name) for m in r.finditer(text)]
assert find("constant.numeric", "1..5 2.5mm .5 1e-3 3turn a1") == ["1", "5", "2.5mm", ".5", "1e-3", "3turn"], \
    find("constant.numeric", "1..5 2.5mm .5 1e-3 3turn a1")
assert find("entity.name.type", "sphere ball { } sphere(") == ["sphere"]
assert find("variable.other.property", "radius = 1 radius == 2") == ["radius"]
assert find("support.function", "sin (1) cos") == ["sin"]
dictionary = open(f"{folder}/meniscus.dict").read().splitlines()
assert all(re.fullmatch(r'#.*|"(?:[^"\\]|\\.)+"', line) for line in dictionary)
assert len(set(dictionary)) == len(dictionary), "a word stands in the dictionary twice"
for keyword in re.search(r"keyword = (.*?) ;", open(f"{folder}/meniscus.ebnf").read(), re.S).group(1).split("|"):
    assert keyword.strip() in dictionary, keyword
PYTHON
result $? "TextMate's grammar and the dictionary"

if vim --version 2>/dev/null | grep -q '+syntax'; then
    printf 'meniscus 1.0 unit mm\nsphere ball { radius = 2.5mm  center = <.5, 1, 2> } // x\nlet a = sin(3) "s" 250ms\n' > "$scratch/a.mns"
    cat > "$scratch/test.vim" <<VIM
syntax on
source $root/grammar/meniscus.vim
let found = []
for [line, column] in [[1, 1], [2, 1], [2, 15], [2, 24], [2, 27], [2, 41], [2, 55], [3, 1], [3, 9], [3, 16], [3, 23]]
  call add(found, synIDattr(synID(line, column, 1), 'name'))
endfor
call writefile(found, '$scratch/found')
qall!
VIM
    vim -e -s -N -u NONE -i NONE "$scratch/a.mns" -S "$scratch/test.vim" < /dev/null > "$scratch/out" 2>&1
    printf 'meniscus%s\n' Header Node Property Number Number Number Comment Keyword Function String Number > "$scratch/wanted"
    diff "$scratch/wanted" "$scratch/found"
    result $? "Vim finds what is what"
fi
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
