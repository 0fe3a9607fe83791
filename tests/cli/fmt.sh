# fmt.sh - fmt: idempotent, and neither a token nor a comment is lost.
# SPDX-License-Identifier: Apache-2.0
: "${scratch:?is set by tests/cli/run.sh, which runs this file}"


begin "fmt: what is laid out stays as it is"
all_scenes
for scene in *.mns; do
    run fmt "$scene"
    exits 0
    cp out once.mns
    run fmt once.mns
    cmp -s out once.mns || flunk "$scene changes when it is laid out again"
done
end

begin "fmt: the examples and the standard library are laid out"
run fmt --check "$root"/examples/*.mns "$root"/src/std/*.mns
exits 0
end

begin "fmt: scenes without their layout get one, and mean the same"
all_scenes
for scene in *.mns; do
    # no indentation, a blank where there were some; comments to the end of the line stay on their lines
    sed -e 's/^[ 	]*//' -e 's/  */ /g' "$scene" > "flat_$scene"
    run fmt -i "flat_$scene"
    exits 0
    run fmt --check "flat_$scene"
    exits 0
    run dump --flat "$scene" # three of tests/lang end in an error
    cp out before.txt
    before=$status
    run dump --flat "flat_$scene"
    exits "$before"
    cmp -s before.txt out || flunk "$scene means something else when it is laid out"
done
end

begin "fmt: tokens, signs, ranges, vectors, comments"
cat > rough.mns <<'SCENE'
/* a */ meniscus 1.0   unit mm // b
let a=1;let b = -a+ - 2*(3-(-1)) ; var c=[1,2 ,3 , ]; c:=[for(i in 0 ..<3)if(i>1)<i,-i>]



def f( a:number=1,b = 2 )=a<b?-a:<1,2>.x
def m(n){

children( )
    if(n>1){m(n-1)}
  else{ print ( "a  b" ) } // c

}
let r = 1. .. 5 by .5  let q = 0 .. .5   let u = f (1) .. f(2)
let w = let (a = 1, b = <1,2>) b * a   let t = not(a > 1 and b<2) ? c[0] : box{}.x
let v = a
 + 2
sphere{radius=1 center=<0,
 1, 2>interior=none}   /* d
   /* e */ f */ box { }
SCENE
cat > smooth.mns <<'SCENE'
/* a */ meniscus 1.0 unit mm  // b
let a = 1  let b = -a + -2 * (3 - (-1))  var c = [1, 2, 3,]  c := [for (i in 0..<3) if (i > 1) <i, -i>]

def f(a: number = 1, b = 2) = a < b ? -a : <1, 2>.x
def m(n) {
  children()
  if (n > 1) { m(n - 1) }
  else { print("a  b") }  // c
}
let r = 1. ..5 by .5  let q = 0.. .5  let u = f(1)..f(2)
let w = let (a = 1, b = <1, 2>) b * a  let t = not (a > 1 and b < 2) ? c[0] : box { }.x
let v = a
  + 2
sphere { radius = 1  center = <0,
  1, 2>  interior = none } /* d
   /* e */ f */ box { }
SCENE
run fmt rough.mns
exits 0
cmp -s out smooth.mns || flunk "$(diff smooth.mns out)"
run fmt --check smooth.mns
exits 0
end

begin "fmt: what is aligned stays aligned"
cat > aligned.mns <<'SCENE'
meniscus 1.0 unit mm
medium glass  { ior = 1.50  tint = rgb(.9, .9, .9)  state = solid }   // the wall
medium whisky { ior = 1.36                          state = liquid }  // the drink
sphere { center = <0, 1, 0>  radius = 2
         interior = glass }
SCENE
run fmt --check aligned.mns
exits 0
sed -i 's/  state = liquid/ state = liquid/' aligned.mns
run fmt aligned.mns
says out 'medium whisky { ior = 1.36  state = liquid }'
end

begin "fmt: a block behind arguments in several lines stands as deep as behind one"
cat > arguments.mns <<'SCENE'
meniscus 1.0 unit mm
def post(at,
         radius = 2) {
  sphere { center = at  radius = radius  interior = air }
  if (radius > 3 and
      radius < 4) {
    post(at + y,
         radius - 1) { }
  }
}
SCENE
run fmt --check arguments.mns
exits 0
end

begin "fmt: line ends of other systems, a byte order mark, an empty tail"
printf '\357\273\277meniscus 1.0\r\nlet a = 1   // x \r\n\r\n\r\n/* y\r\n z */\r\n' > dos.mns
run fmt dos.mns
exits 0
printf 'meniscus 1.0\nlet a = 1   // x\n\n/* y\n z */\n' | cmp -s - out || flunk "$(od -c out)"
end

begin "fmt --check names what would change; -i changes it, atomically"
printf 'meniscus 1.0\nlet a=1\n' > rough.mns
printf 'meniscus 1.0\nlet a = 1\n' > smooth.mns
run fmt --check rough.mns smooth.mns
exits 1
says out rough.mns
says_not out smooth.mns
run fmt -i rough.mns smooth.mns
exits 0
empty out
cmp -s rough.mns smooth.mns || flunk "rough.mns is not laid out"
no_leftovers
run fmt rough.mns smooth.mns
exits 2
end

begin "fmt: standard input"
printf 'meniscus 1.0\nlet a=1\n' | "$program" fmt - > out 2> err
status=$?
exits 0
says out 'let a = 1'
end

begin "fmt: a scene with mistakes stays as it is; status 3"
printf 'meniscus 1.0\nlet a=1 let let\n' > bad.mns
cp bad.mns same.mns
run fmt -i bad.mns
exits 3
says err '[syntax]'
cmp -s bad.mns same.mns || flunk "bad.mns was changed"
run fmt missing.mns
exits 4
end
