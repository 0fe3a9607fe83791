#!/bin/sh
# The examples of grammar/spec.md mean what their marks say: tests/spec.py.
# usage: tests/spec.sh MENISCUS
# SPDX-License-Identifier: Apache-2.0
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
exec "${PYTHON:-python3}" "$root/tests/spec.py" "$1" "$root/grammar/spec.md"
