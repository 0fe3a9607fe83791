#!/bin/sh
# Scenes of random shapes: see random_scenes.py. usage: tests/random.sh MENISCUS [FIRST LAST]
# SPDX-License-Identifier: Apache-2.0
exec python3 tests/random_scenes.py "$1" "${2:-1}" "${3:-20}"
