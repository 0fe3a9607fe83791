#!/usr/bin/env python3
"""Scenes of random shapes that nest, overlap and touch, of clear media that absorb nothing, under an even sky: no ray may contradict
the list of media that it is in, and every pixel must be that of the empty scene.

usage: random_scenes.py MENISCUS FIRST LAST    (seeds; a scene is the same whenever it is made)
A scene that fails stays in the current folder. The last line is "N passed, N failed".
SPDX-License-Identifier: Apache-2.0
"""
import json
import os
import random
import subprocess
import sys
import tempfile

HEAD = """meniscus 1.0 unit cm
medium glass { ior = 1.52  state = solid }
medium water { ior = 1.33  state = liquid }
medium oil { ior = 1.47  state = liquid }
medium ice { ior = 1.31  state = solid }
medium gem { ior = 2.4  state = solid }
def bumps(x, y, z) = x * x + y * y + z * z - 4 + .5 * sin(3 * x) * sin(3 * y) * sin(3 * z)
def edges(x, y, z) = abs(x) + abs(y) + abs(z) - 2
render { bounces = 65535 }
"""
WIDTH, HEIGHT, SAMPLES = 80, 60, 64
# Interpolated normals lead a path in some 300,000, and here and there in 50,000, into total reflection that never ends, as no way that turns round would.
LOST = 12
MEDIA = ["glass", "water", "oil", "ice", "gem", "air"]
SKY = "environment { color = 1 }\n"
CUBE = ("<0, 2, 3>, <0, 3, 1>, <4, 5, 7>, <4, 7, 6>, <0, 1, 5>, <0, 5, 4>, "
        "<2, 6, 7>, <2, 7, 3>, <0, 4, 6>, <0, 6, 2>, <1, 3, 7>, <1, 7, 5>")
LATHE = "[<0, 0>, <%.9g, 0>, <%.9g, 4>, <%.9g, 4>, <%.9g, .5>, <0, .5>]"


class Maker:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.on_grid = self.random.random() < 0.5  # then faces and edges often lie in each other

    def between(self, low, high):
        return self.random.uniform(low, high)

    def place(self):
        x = self.between(-6, 6)
        return round(x) if self.on_grid and self.random.random() < 0.8 else x

    def size(self, low, high):
        x = self.between(low, high)
        return max(1, round(x)) if self.on_grid and self.random.random() < 0.7 else x

    def point(self):
        return "<%.9g, %.9g, %.9g>" % (self.place(), self.place(), self.place())

    def turn(self):
        if self.on_grid:
            return self.random.choice(["", "", "rotate(y, 90)", "rotate(y, 45)"])
        angles = tuple(self.between(0, 360) for _ in range(3))
        factors = tuple(self.between(0.5, 2) for _ in range(3))
        return self.random.choice(["", "", "rotate(y, %.9g)" % angles[0], "rotate(<%.9g, %.9g, %.9g>)" % angles,
                                   "scale(<%.9g, %.9g, %.9g>)" % factors])

    def corners(self):
        low = [self.place() for _ in range(3)]
        return low, [x + self.size(0.3, 6) for x in low]

    def cube(self):
        low, high = self.corners()
        points = ["<%.9g, %.9g, %.9g>" % (x, y, z) for z in (low[2], high[2]) for y in (low[1], high[1])
                  for x in (low[0], high[0])]
        return "mesh { positions = [%s]  triangles = [%s]" % (", ".join(points), CUBE)

    def heights(self):
        high = self.random.choice([0, 0.1, 1])
        columns, rows = self.random.choice([3, 8, 40]), self.random.choice([3, 8, 40])
        row = lambda: "[%s]" % ", ".join("%.6g" % (1 + high * self.random.random()) for _ in range(columns))
        return "height_field { heights = [%s]  size = <%.9g, %.9g, %.9g>  translate(%s)" % (
            ", ".join(row() for _ in range(rows)), self.size(3, 14), self.size(0.5, 3), self.size(3, 14), self.point())

    def simple(self):
        """A shape, up to what it is of."""
        of = self.between
        low, high = self.corners()
        return self.random.choice([
            lambda: "sphere { center = %s  radius = %.9g" % (self.point(), self.size(0.3, 4)),
            lambda: "box { from = <%.9g, %.9g, %.9g>  to = <%.9g, %.9g, %.9g>" % (*low, *high),
            lambda: "cylinder { from = %s  to = %s  radius = %.9g" % (self.point(), self.point(), self.size(0.3, 3)),
            lambda: "cone { from = %s  to = %s  radius_from = %.9g  radius_to = %.9g" % (
                self.point(), self.point(), self.size(0.3, 3), self.random.choice([0, of(0.1, 3)])),
            lambda: "torus { radius = %.9g  tube = %.9g  rotate(x, %.9g)  translate(%s)" % (
                of(1.5, 4), of(0.2, 1.4), of(0, 180), self.point()),
            lambda: "lathe { profile = %s  %s  translate(%s)" % (
                LATHE % (of(2, 3), of(3, 5), of(2.4, 2.85), of(1.2, 1.9)),
                self.random.choice(["", "rounding = [0, .1, .05, .05, .2, 0]"]), self.point()),
            lambda: "capsule { from = %s  to = %s  radius = %.9g" % (self.point(), self.point(), self.size(0.3, 2)),
            lambda: "ellipsoid { center = %s  radii = <%.9g, %.9g, %.9g>" % (
                self.point(), of(0.3, 4), of(0.3, 4), of(0.3, 4)),
            lambda: "prism { outline = [<0, 0>, <3, 0>, <4, 2>, <2, %.9g>, <0, 3>]  from = 0  to = %.9g  translate(%s)" % (
                of(1.5, 5), self.size(0.5, 4), self.point()),
            lambda: "superellipsoid { exponents = <%.9g, %.9g>  radius = <%.9g, %.9g, %.9g>  translate(%s)" % (
                of(0.2, 2), of(0.2, 2), of(1, 4), of(1, 4), of(1, 4), self.point()),
            lambda: "isosurface { function = %s  from = <-3, -3, -3>  to = <3, 3, 3>  translate(%s)" % (
                self.random.choice(["bumps", "edges"]), self.point()),
            self.cube, self.heights])()

    def shape(self, what, depth=0):
        if depth < 2 and self.random.random() < 0.15:
            kind = self.random.choice(["union", "difference", "difference", "intersection"])
            return "%s { %s\n  %s\n  %s }" % (kind, what, self.shape("", depth + 1), self.shape("", depth + 1))
        return "%s  %s  %s }" % (self.simple(), self.turn(), what)

    def scene(self):
        shapes = [self.shape("interior = " + self.random.choice(MEDIA)) for _ in range(self.random.choice([3, 6, 12, 25]))]
        camera = "camera { from = <%.9g, %.9g, 30>  to = <0, 0, 0>  fov = 32 }\n" % (self.between(-10, 10), self.between(-3, 15))
        return shapes, camera


def run(meniscus, *arguments):
    return subprocess.run([meniscus, *arguments], capture_output=True, text=True)


def render(meniscus, name, shapes, camera):
    """None where the scene is refused."""
    with open(name + ".mns", "w") as file:
        file.write(HEAD + "\n".join(shapes) + "\n" + SKY + camera)
    done = run(meniscus, "render", name + ".mns", "--size", "%dx%d" % (WIDTH, HEIGHT), "-s", str(SAMPLES), "--caustics", "off",
               "--fireflies", "keep", "--no-absorption", "--stats=" + name + ".json", "-o", name + ".exr")
    if done.returncode != 0:
        return None
    with open(name + ".json") as file:
        return json.load(file)


def try_scene(meniscus, seed, empty):
    """What is wrong, or "" where nothing is; None where there was no such scene."""
    name = "random%d" % seed
    shapes, camera = Maker(seed).scene()
    stats = render(meniscus, name, shapes, camera)
    if not stats:
        return None
    furnace = json.loads(run(meniscus, "compare", name + ".exr", empty, "--json").stdout)
    wrong = "%d nesting faults; " % stats["nestingFaults"] if stats["nestingFaults"] else ""
    lost = WIDTH * HEIGHT * SAMPLES * max(abs(a - b) for a, b in zip(furnace["meanA"], furnace["meanB"]))
    if lost > LOST or furnace["maxDifference"] > LOST / SAMPLES:
        wrong += "%.1f paths are missing; " % lost
    if stats["silentLimit"] or stats["badSamples"]:
        wrong += "%d paths gave up, %d samples are bad" % (stats["silentLimit"], stats["badSamples"])
    return wrong


def main():
    meniscus, first, last = os.path.abspath(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    home, n_passed, n_failed, n_refused = os.getcwd(), 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        render(meniscus, "empty", ["box { to = <-1, 1, 1>  from = <-900, 0, 90>  interior = air }"],
               "camera { from = <0, 0, 30>  to = <0, 0, 0>  fov = 32 }\n")
        for seed in range(first, last + 1):
            wrong = try_scene(meniscus, seed, "empty.exr")
            if wrong:
                os.replace("random%d.mns" % seed, os.path.join(home, "random%d.mns" % seed))
                print("random%d.mns: %s" % (seed, wrong), flush=True)
            n_refused += wrong is None
            n_passed += wrong == ""
            n_failed += bool(wrong)
        os.chdir(home)
    print("%d scenes were refused: touching edges, roundings that do not fit" % n_refused)
    print("%d passed, %d failed" % (n_passed, n_failed))
    return n_failed > 0 or n_passed == 0


if __name__ == "__main__":
    sys.exit(main())
