#!/bin/sh
# What is left of light along random lines: see random_lines.py. usage: tests/lines.sh MENISCUS [FIRST LAST]
# SPDX-License-Identifier: Apache-2.0
exec python3 tests/random_lines.py "$1" "${2:-1}" "${3:-8}"
