# many.sh - a scene of very many objects fits in memory, in proportion to their number.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

many() {
    cat > many.mns << 'END'
meniscus 1.0 unit cm
param n = 1
medium gas { ior = 1  state = gas }
environment { }
camera { from = <50, 50, 300>  to = <50, 50, 50> }
END
    echo "let b = $1" >> many.mns
    echo 'for (i in 1..n) { b { translate(<100 * rnd(1, i), 100 * rnd(2, i), 100 * rnd(3, i)>) } }' >> many.mns
}
# most_memory N: the largest resident set of a check of n = N, in kilobytes; the sanitizers have a memory of their own
most_memory() {
    "$python" - "$program" "$1" << 'END'
import os, subprocess, sys
process = subprocess.Popen([sys.argv[1], "check", "-q", "--threads", "1", "-D", "n=" + sys.argv[2], "many.mns"], stderr=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(usage.ru_maxrss if status == 0 else 0)
END
}
# within BYTES WHAT: for each of 300,000 objects, beyond what the first ones take
within() {
    few=$(most_memory 10)
    all=$(most_memory 300000)
    [ "$few" -gt 0 ] && [ "$all" -gt 0 ] || flunk "check of $2 failed"
    each=$(((all - few) * 1024 / 300000))
    [ -z "${MENISCUS_SHOW:-}" ] || echo "$2: $each bytes"
    case $program in */asan/* | */hostile/* | */tsan/*) return ;; esac
    [ "$each" -le "$1" ] || flunk "$2 take $each bytes each; $1 are allowed"
}

begin "many: 300,000 bubbles take at most 700 bytes each"
many 'sphere { interior = gas  radius = .1 }'
within 700 bubbles
end

begin "many: 300,000 instances of a mesh take at most 940 bytes each"
many 'box { interior = gas  size = <.1, .1, .1> }'
within 940 instances
end
