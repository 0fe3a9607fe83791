#!/bin/sh
# Turns scene texts into C: their bytes, and the table of scene/library.h.
# usage: src/std/embed.sh src/std/*.mns > std_library.c
# SPDX-License-Identifier: Apache-2.0
set -eu
echo '/* Generated from src/std by src/std/embed.sh. */'
echo '#include "base/attr.h"'
echo '#include "scene/library.h"'
for file in "$@"; do
    echo
    echo "static const char text_of_$(basename "$file" .mns)[] = {"
    od -An -v -b "$file" | sed "s/ \\([0-7]*\\)/'\\\\\\1',/g; s/^/    /"
    echo '    0};'
done
echo
echo 'static const EvalLibraryFile files[] = {'
for file in "$@"; do
    stem=$(basename "$file" .mns)
    echo "    {\"std/$stem.mns\", text_of_$stem, sizeof text_of_$stem - 1},"
done
echo '};'
echo 'const EvalLibrary std_library = {files, COUNT_OF(files)};'
