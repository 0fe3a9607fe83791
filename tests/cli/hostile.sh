# hostile.sh - scenes that are made to hang or to fill the memory end soon, in an error, within the memory they are given.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"

# ends_within SECONDS SLUG: check of hostile.mns ends in an error of that slug, with a hint, within so many seconds of the
# processor, and in 6 GB of address space
ends_within() {
    # sanitizers reserve more address space than there is, and take their time
    (case $program in */asan/* | */hostile/* | */tsan/*) ;; *) ulimit -v 6000000; ulimit -t "$1" ;; esac
     exec "$program" check hostile.mns > out 2> err < /dev/null)
    status=$?
    [ $status -lt 129 ] || flunk "died with status $status within $1 s: $(head -c 200 hostile.mns)"
    exits 3
    says err "[$2]"
    matches err '^ *= hint: '
}
# What needs no work ends at once: a tenth of a second. What runs up to a limit of steps or of memory ends in seconds. Both
# have ten times as long here and more, for the test is of what has no end, not of how fast a loaded machine is.
ends_at_once() { ends_within 10 "$1"; }
ends() { ends_within 200 "$1"; }
hostile() { { echo 'meniscus 1.0 unit mm'; cat; } > hostile.mns; }
# repeated COUNT TEXT
repeated() { "$python" -c 'import sys; sys.stdout.write(sys.argv[2] * int(sys.argv[1]))' "$1" "$2"; }

begin "hostile: loops without an end"
echo 'var n = 0  for (i in 1..1e9) { n := n + i }' | hostile
ends limit
says err 'more than 200000000 steps'
echo 'while (true) { }' | hostile
ends limit
echo 'for (i in 1..1e12) { sphere { surface = surface { } } }' | hostile
ends limit
says err 'more than 15000000 nodes'
end

begin "hostile: conditions in conditions, without their braces"
repeated 200000 'if (1) ' | hostile
ends_at_once syntax
says err 'and 181 more errors'
end

begin "hostile: what grows without an end"
echo 'var s = "a"  while (true) { s := s + s }' | hostile
ends_at_once limit
echo 'var l = [1]  while (true) { l := l + l }' | hostile
ends limit
echo 'print([for (i in 1..1e12) i])' | hostile
ends limit
echo 'print([for (i in 1..1e6) for (j in 1..1e6) <i, j>])' | hostile
ends limit
echo 'var l = [1]  while (true) { l := [l] }' | hostile
ends too-deep
echo 'var g = sphere { surface = surface { } }  while (true) { g := group { g { } } }' | hostile
ends_at_once too-deep
echo 'while (true) { print("wine and water") }' | hostile
ends limit
end

begin "hostile: calls without an end"
echo 'def f(n) = f(n + 1)  print(f(1))' | hostile
ends_at_once too-deep
echo 'def a() { b() }  def b() { a() }  a()' | hostile
ends_at_once too-deep
echo 'def fib(n) = n < 2 ? n : fib(n - 1) + fib(n - 2)  print(fib(90))' | hostile
ends limit
echo 'def tree(n) { if (n > 0) { group { tree(n - 1)  tree(n - 1)  tree(n - 1) } } else { sphere { surface = surface { } } } }
tree(40)' | hostile
ends limit
end

begin "hostile: depth of what is written"
{ printf 'let a = '; repeated 100000 '('; } | hostile
ends_at_once too-deep
{ printf 'let a = '; repeated 100000 '['; } | hostile
ends_at_once too-deep
{ printf 'let a = '; repeated 100000 '-'; echo 1; } | hostile
ends_at_once too-deep
repeated 100000 'group { ' | hostile
ends_at_once too-deep
{ printf 'let a = 1'; repeated 100000 ' + 1'; } | hostile
ends_at_once syntax
says err 'more than 2000 operators'
{ printf 'let a = 1'; repeated 100000 ' ^ 1'; } | hostile
ends_at_once too-deep
{ printf 'let a = b'; repeated 100000 '.x'; } | hostile
ends_at_once syntax
{ repeated 100000 'if (true) { } else '; echo '{ }'; } | hostile
run check hostile.mns
[ $status -ne 139 ] || flunk "a long chain of else-ifs"
end

begin "hostile: too many arguments, names joined by dots, mistakes in values"
{ printf 'print(max('; repeated 70 '1, '; echo '1))'; } | hostile
run check hostile.mns
exits 3
says err 'at most 64 arguments'
echo 'a.b.c.d.e { }' | hostile
ends_at_once syntax
says err "more than 4 names joined by '.'"
i=0
while [ $i -lt 12000 ]; do i=$((i + 1)); echo "print($i + \"a\")"; done | hostile
run check hostile.mns
exits 3
says err '10001 errors'
end

begin "hostile: files that lead to themselves, and many of them"
echo 'include "hostile.mns"' | hostile
run check hostile.mns
exits 3
says err '[import-circle]'
for i in 0 1 2 3 4 5 6 7 8 9; do for j in 0 1 2 3 4 5 6; do
    printf 'meniscus 1.0\ninclude "deep_%d.mns"\n' $((10 * i + j + 1 + 3 * (j == 6))) > deep_$((10 * i + j)).mns
done; done
printf 'meniscus 1.0\n' > deep_100.mns
echo 'include "deep_0.mns"' | hostile
ends_at_once too-deep
end

begin "hostile: one huge token, one huge number, many mistakes"
{ printf 'let a = "'; repeated 20000000 'a'; echo '"'; } | hostile
ends_at_once limit
{ printf 'let '; repeated 20000000 'a'; echo ' = 1'; } | hostile
ends_at_once limit
{ printf 'let a = '; repeated 20000000 '9'; echo; } | hostile
run check hostile.mns
exits 3
says err '[invalid-number]'
{ printf '/* '; repeated 2000000 '/* '; } | hostile
run check hostile.mns
exits 3
says err '[unterminated-comment]'
{ repeated 200000 '} '; } | hostile
run check hostile.mns
exits 3
{ repeated 20000 'sphere { radius 3 , hollow } '; } | hostile
run check hostile.mns
exits 3
says err 'which are not shown'
{ repeated 20000 "let a = 'x  if a "; } | hostile
run check hostile.mns
exits 3
{ repeated 20000 'f(1 2 '; } | hostile
run check hostile.mns
exits 3
end

begin "hostile: a text through a pipe that does not end is cut off at the limit"
[ -n "${MENISCUS_TEST_LARGE:-}" ] && {
    { echo 'meniscus 1.0 unit mm'; printf 'let a = "'; head -c 1100000000 /dev/zero | tr '\0' a; } |
        (ulimit -v 6000000; timeout 600 "$program" check - > out 2> err)
    status=$?
    exits 4
    says err 'larger than the limit'
}
head -c 300000 /dev/urandom > noise.mns
run check noise.mns
exits 3
says err '[invalid-utf8]'
end
