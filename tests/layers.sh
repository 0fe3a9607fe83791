#!/bin/sh
# A folder of src may include itself and the folders named here, and nothing else; Embree, OpenEXR and C++ stay behind
# their own files. See the layout in src/README.md.
# usage: tests/layers.sh [MENISCUS]
# SPDX-License-Identifier: Apache-2.0
set -u
cd "$(dirname "$0")/.." || exit 2
n_passed=0 n_failed=0
# verdict NAME LINES: passes when LINES is empty
verdict() {
    if [ -z "$2" ]; then n_passed=$((n_passed + 1)); else
        n_failed=$((n_failed + 1))
        printf 'not ok - %s\n%s\n' "$1" "$2"
    fi
}
while read -r folder allowed; do
    bad=''
    for include in $(grep -hoE '^#include "[a-z]+/' "src/$folder"/*.[ch]* 2> /dev/null | sed 's/.*"//; s|/||' | sort -u); do
        case " $folder $allowed " in *" $include "*) ;; *)
            bad="$bad
    $(grep -lE "^#include \"$include/" "src/$folder"/*.[ch]*) includes $include" ;;
        esac
    done
    verdict "includes of src/$folder" "$bad"
done << 'TABLE'
base
diag base
lang base diag
nest base
optics base
mesh base diag
shape base diag mesh
geom base mesh shape
image base diag
scene base diag lang nest optics mesh shape geom
import base diag lang mesh scene
check base diag nest optics mesh shape geom scene
trace base nest optics mesh shape geom scene
render base diag image scene trace
preview base image
cli base diag lang nest optics mesh shape geom image scene import check trace render preview
TABLE
known='src|grammar|examples|tests|man|README\.md|Makefile|LICENSE|CHANGES|VERSION|\..*'
verdict 'nothing else at the top level' "$(git ls-files 2> /dev/null | sed 's|/.*||' | sort -u | grep -vxE "$known")"
verdict 'Embree only behind geom/embree.h' "$(grep -lE 'include <embree' -r src --include='*.[ch]' | grep -v '^src/geom/embree.h$')"
verdict 'geom/embree.h only in geom/rtc*' "$(grep -lE 'geom/embree.h|rtc_scene.h' -r src --include='*.[ch]' | grep -vE '^src/geom/(rtc|embree)')"
verdict 'OpenEXR only behind image/exr_parts.h' "$(grep -lE 'include <openexr' -r src --include='*.[ch]' | grep -v '^src/image/exr_parts.h$')"
verdict 'image/exr_parts.h only in image/exr*' "$(grep -l 'image/exr_parts.h' -r src --include='*.[ch]' | grep -v '^src/image/exr')"
verdict 'Jansson only behind mesh/gltf_data' "$(grep -lE 'include <jansson' -r src --include='*.[ch]' | grep -v '^src/mesh/gltf_data.h$')"
verdict 'FreeType only in shape/glyphs.c' "$(grep -l 'ft2build' -r src --include='*.[ch]' | grep -v '^src/shape/glyphs.c$')"
verdict 'Chafa only in preview/terminal_picture.c' "$(grep -lE 'include <chafa' -r src --include='*.[ch]' | grep -v '^src/preview/terminal_picture.c$')"
verdict 'C++ only in image/ocio.cpp' "$(find src -name '*.cpp' -o -name '*.cc' -o -name '*.hpp' | grep -v '^src/image/ocio.cpp$')"
verdict 'file names are unique' "$(find src -type f ! -name README.md -printf '%f\n' | sort | uniq -d)"
verdict 'no file over 1,000 lines' "$(find src -name '*.[ch]' -exec wc -l {} + | awk '$1 > 1000 && $2 != "total"')"
verdict 'no unsafe or locale-bound functions' \
    "$(grep -nE '\b(strcpy|strcat|sprintf|strtok|gets|setlocale|rand|srand|atof|atoi)\(' -r src --include='*.c')"
# base/arena.c: see Conventions in src/README.md
verdict 'nothing below cli prints or exits' \
    "$(grep -nE '\b(f?printf|f?puts|putchar|perror|exit|abort)\(|\b(stdout|stderr)\b' -r src --include='*.c' |
        grep -vE '^src/(cli/|optics/[a-z]*_gen.c|base/arena.c)')"
verdict 'nothing is left open' "$(grep -nE 'FIXME|XXX|TODO' -r src grammar examples man Makefile 2> /dev/null)"
# The linker would take the program's instead, for the libraries, too.
names() { nm "$@" 2> /dev/null | awk 'NF == 3 && $2 ~ /[TDBRW]/ { sub(/@.*/, "", $3); print $3 }' | sort -u; }
if [ $# -ge 1 ] && command -v nm > /dev/null; then
    own=$(mktemp) others=$(mktemp)
    names -g --defined-only "$(dirname "$1")/libmeniscus.a" > "$own"
    ldd "$1" | awk '$3 ~ "^/" && $3 !~ "/libstdc" { print $3 }' | while read -r library; do names -D --defined-only "$library"; done | sort -u > "$others"
    [ -s "$own" ] && [ -s "$others" ] || verdict 'names of functions' 'nm lists none'
    verdict 'no function bears the name of a library function' "$(comm -12 "$own" "$others" | grep -v '^_')"
    rm -f "$own" "$others"
fi
echo "$n_passed passed, $n_failed failed"
[ "$n_failed" -eq 0 ]
