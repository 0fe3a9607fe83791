#!/bin/sh
# Random sentences of the grammar are accepted, and mutations that leave it are refused: tests/grammar/sentences.py.
# usage: tests/grammar.sh MENISCUS [SENTENCES [SEED]]
# SPDX-License-Identifier: Apache-2.0
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
exec "${PYTHON:-python3}" "$root/tests/grammar/sentences.py" "$1" "$root/grammar/meniscus.ebnf" "${2:-2000}" "${3:-1}"
