#!/usr/bin/env python3
"""Random solids that overlap, of media that absorb and do not refract: what of the light is left along random lines is what a model
finds that knows of each solid only which points are inside, and of two that overlap which one is on top.

usage: random_lines.py MENISCUS FIRST LAST    (seeds; a scene is the same whenever it is made)
The lines of a scene are the frames of an animation; half of them start among the solids. Half of the scenes state priorities, in the
others the order is that of containment, state of matter, volume and declaration; those are left out in which points that are tried do
not tell which of these decides. A scene that differs stays in the current folder. The last line is "N passed, N failed".
SPDX-License-Identifier: Apache-2.0
"""
import json
import math
import os
import random
import subprocess
import sys
import tempfile

LINES = 24
LENGTH = 60
STEPS, FINE_STEPS, HALVINGS = 1500, 40000, 40
ALLOWED = 2e-4  # of the light that is left; what float makes of it
OUTSIDE = 0  # the world's medium
GRID = [-5.5 + i for i in range(12)]  # along each axis: points that tell of volumes, and of what contains what
STATES = ["liquid", "gas", "solid"]  # the later one is on top


def add(a, b, times=1):
    return tuple(x + times * y for x, y in zip(a, b))


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def text_of(vector):
    return "<%s>" % ", ".join("%.9g" % x for x in vector)


def encloses(outline, x, y):
    """Whether a point is inside of a polygon."""
    inside = False
    for (x1, y1), (x2, y2) in zip(outline, outline[1:] + outline[:1]):
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) * (x2 - x1) / (y2 - y1):
            inside = not inside
    return inside


class Maker:
    """Every shape is its text, up to the end of its properties, and a function that says whether a point is inside."""

    def __init__(self, seed):
        self.random = random.Random(seed)

    def between(self, low, high):
        return self.random.uniform(low, high)

    def point(self, far=3):
        return tuple(self.between(-far, far) for _ in range(3))

    def direction(self):
        while True:
            vector = self.point(1)
            if 0.1 < dot(vector, vector) < 1:
                return tuple(x / math.sqrt(dot(vector, vector)) for x in vector)

    def sphere(self):
        center, radius = self.point(), self.between(0.5, 3)
        return ("sphere { center = %s  radius = %.9g" % (text_of(center), radius),
                lambda p: math.dist(p, center) < radius)

    def ellipsoid(self):
        center, radii = self.point(), tuple(self.between(0.4, 3) for _ in range(3))
        return ("ellipsoid { center = %s  radii = %s" % (text_of(center), text_of(radii)),
                lambda p: sum(((x - c) / r) ** 2 for x, c, r in zip(p, center, radii)) < 1)

    def box(self):
        low = self.point()
        high = tuple(x + self.between(0.3, 4) for x in low)
        return ("box { from = %s  to = %s" % (text_of(low), text_of(high)),
                lambda p: all(a < x < b for a, x, b in zip(low, p, high)))

    def rod(self, name):
        start, axis, length, radius = self.point(), self.direction(), self.between(0.3, 5), self.between(0.3, 2)
        other = self.between(0, 2) if name == "cone" else radius
        radii = "radius_from = %.9g  radius_to = %.9g" % (radius, other) if name == "cone" else "radius = %.9g" % radius

        def inside(p):
            along = dot(add(p, start, -1), axis)
            nearest = min(max(along, 0), length)
            if name != "capsule" and nearest != along:
                return False
            return math.dist(p, add(start, axis, nearest)) < radius + (other - radius) * nearest / length

        return "%s { from = %s  to = %s  %s" % (name, text_of(start), text_of(add(start, axis, length)), radii), inside

    def torus(self):
        center, radius, tube = self.point(), self.between(0.5, 2.5), self.between(0.2, 1.5)

        def inside(p):
            x, y, z = add(p, center, -1)
            return (math.hypot(x, z) - radius) ** 2 + y * y < tube * tube

        return "torus { center = %s  radius = %.9g  tube = %.9g" % (text_of(center), radius, tube), inside

    def lathe(self):
        bottom, top, height = self.between(1, 3), self.between(1, 3), self.between(1, 4)
        wall = min(self.between(0.1, 0.4 * height), 0.8)
        profile = [(0, 0), (bottom, 0), (top, height), (top - wall, height), (bottom - wall, wall), (0, wall)]
        return ("lathe { profile = [%s]" % ", ".join(map(text_of, profile)),
                lambda p: encloses(profile, math.hypot(p[0], p[2]), p[1]))

    def prism(self):
        n, low = self.random.randint(3, 7), self.between(-3, 1)
        high = low + self.between(0.5, 4)
        radii = [self.between(0.6, 3) for _ in range(n)]
        outline = [(r * math.cos(2 * math.pi * i / n), r * math.sin(2 * math.pi * i / n)) for i, r in enumerate(radii)]
        return ("prism { outline = [%s]  from = %.9g  to = %.9g" % (", ".join(map(text_of, outline)), low, high),
                lambda p: low < p[1] < high and encloses(outline, p[0], p[2]))

    def tetrahedron(self):
        corners = [self.point(3.5) for _ in range(4)]
        faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]

        def height(face, p):
            """Times the area: of p over a face's plane, outward."""
            a, u, v = corners[face[0]], add(corners[face[1]], corners[face[0]], -1), add(corners[face[2]], corners[face[0]], -1)
            normal = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            return dot(normal, add(p, a, -1))

        volume = -height(faces[0], corners[3])
        if abs(volume) < 3:
            return self.tetrahedron()
        if volume < 0:
            corners[0], corners[1] = corners[1], corners[0]
        return ("mesh { positions = [%s]  triangles = [%s]" % (", ".join(map(text_of, corners)), ", ".join(map(text_of, faces))),
                lambda p: all(height(face, p) < 0 for face in faces))

    def cut_ball(self):
        center, radius, normal = self.point(), self.between(1, 3), self.direction()
        distance = dot(center, normal) + self.between(-0.5, 0.5) * radius
        return ("intersection { sphere { center = %s  radius = %.9g }  plane { normal = %s  distance = %.9g }" % (
            text_of(center), radius, text_of(normal), distance),
                lambda p: math.dist(p, center) < radius and dot(p, normal) < distance)

    def simple(self):
        return self.random.choice([
            self.sphere, self.ellipsoid, self.box, self.torus, self.lathe, self.prism, self.tetrahedron, self.cut_ball,
            lambda: self.rod("cylinder"), lambda: self.rod("capsule"), lambda: self.rod("cone")])()

    def transform(self):
        """Its text, and the place that a point of the world has before it."""
        kind, by = self.random.choice(["rotate", "scale", "mirror", "translate"]), self.point(1)
        if kind == "translate":
            return "translate(%s)" % text_of(by), lambda p: add(p, by, -1)
        if kind == "mirror":
            return "scale(<-1, 1, 1>)", lambda p: (-p[0], p[1], p[2])
        if kind == "scale":
            factors = tuple(self.between(0.5, 1.6) for _ in range(3))
            return "scale(%s)" % text_of(factors), lambda p: tuple(x / f for x, f in zip(p, factors))
        axis, degrees = self.random.randrange(3), self.random.choice([90, 45, self.between(0, 360)])
        cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))

        def back(p):
            q, b, c = list(p), (axis + 1) % 3, (axis + 2) % 3
            q[b], q[c] = cosine * p[b] + sine * p[c], cosine * p[c] - sine * p[b]
            return tuple(q)

        return "rotate(%s, %.9g)" % ("xyz"[axis], degrees), back

    def placed(self):
        text, inside = self.simple()
        for _ in range(self.random.choice([0, 0, 1, 2, 3])):
            words, back = self.transform()
            text, inside = "%s  %s" % (text, words), (lambda p, inside=inside, back=back: inside(back(p)))
        return text, inside

    def solid(self, depth=0):
        if self.random.random() >= (0.3, 0.15, 0)[depth]:
            return self.placed()
        kind = self.random.choice(["union", "intersection", "difference"])
        parts = [self.solid(depth + 1) for _ in range(self.random.choice([2, 2, 3]))]
        first, others = parts[0][1], [inside for _, inside in parts[1:]]
        return ("%s { %s" % (kind, "  ".join(text + " }" for text, _ in parts)), {
            "union": lambda p: first(p) or any(inside(p) for inside in others),
            "intersection": lambda p: first(p) and all(inside(p) for inside in others),
            "difference": lambda p: first(p) and not any(inside(p) for inside in others)}[kind])

    def line(self):
        """Where it starts, and its direction."""
        direction, start = self.direction(), self.point()
        return (start if self.random.random() < 0.5 else add(start, direction, -LENGTH / 2)), direction


class Scene:
    def __init__(self, seed):
        maker = Maker(seed)
        self.absorption = [0] + [round(maker.between(0.05, 0.6), 3) for _ in range(maker.random.randint(2, 4))]
        self.states = ["gas"] + [maker.random.choice(STATES) for _ in self.absorption[1:]]
        n = maker.random.randint(2, 8)
        self.priorities = maker.random.sample(range(n), n) if maker.random.random() < 0.5 else None
        solids = [maker.solid() for _ in range(n)]
        self.texts, self.inside = [text for text, _ in solids], [inside for _, inside in solids]
        self.media = [maker.random.randrange(len(self.absorption)) for _ in range(n)]
        self.lines = [maker.line() for _ in range(LINES)]
        self.wins = {} if self.priorities else self.decide()  # (a, b): whether a is on top; None: it is not known

    def decide(self):
        points = [(x, y, z) for x in GRID for y in GRID for z in GRID]
        within = [{p for p in points if inside(p)} for inside in self.inside]
        return {(a, b): self.is_on_top(within[a], within[b], a, b) for a in range(len(within)) for b in range(a)}

    def is_on_top(self, within_a, within_b, a, b):
        """None where the points do not tell; a was declared later."""
        both, least = len(within_a & within_b), min(len(within_a), len(within_b))
        if both > 0.9 * least or least < 30:  # one may contain the other
            if both < least or max(len(within_a), len(within_b)) < 1.3 * least or least < 30:
                return None
            return len(within_a) < len(within_b)
        state_a, state_b = (STATES.index(self.states[self.media[i]]) for i in (a, b))
        if state_a != state_b:
            return state_a > state_b
        if max(len(within_a), len(within_b)) < 1.3 * least:
            return None
        return len(within_a) < len(within_b)

    def medium_at(self, p):
        """None where it is not known."""
        around = [i for i, inside in enumerate(self.inside) if inside(p)]
        if not around:
            return OUTSIDE
        if self.priorities:
            return self.media[max(around, key=lambda i: self.priorities[i])]
        for a in around:
            answers = [self.wins[a, b] if a > b else self.wins[b, a] for b in around if b != a]
            if None in answers:
                return None
            if all(answer == (a > b) for answer, b in zip(answers, (b for b in around if b != a))):
                return self.media[a]
        return None  # they run in a circle

    def cuts(self, inside, start, direction, steps):
        """Where a line enters or leaves a solid."""
        within = [inside(add(start, direction, LENGTH * k / steps)) for k in range(steps + 1)]
        for k in range(steps):
            if within[k] == within[k + 1]:
                continue
            low, high = LENGTH * k / steps, LENGTH * (k + 1) / steps
            for _ in range(HALVINGS):
                middle = (low + high) / 2
                low, high = (middle, high) if inside(add(start, direction, middle)) == within[k] else (low, middle)
            yield low

    def left_along(self, start, direction, steps):
        """What of the light is left; None where that is not known."""
        at = sorted([0, LENGTH] + [cut for inside in self.inside for cut in self.cuts(inside, start, direction, steps)])
        depth = 0
        for begin, end in zip(at, at[1:]):
            medium = self.medium_at(add(start, direction, (begin + end) / 2))
            if medium is None:
                return None
            depth += self.absorption[medium] * (end - begin)
        return math.exp(-depth)

    def text(self):
        media = ["medium m%d { ior = 1  absorption = %g / 1cm  state = %s }" % (i, self.absorption[i], self.states[i])
                 for i in range(1, len(self.absorption))]
        objects = ["%s  interior = %s %s }" % (text, "m%d" % medium if medium else "air",
                                              " priority = %d" % self.priorities[i] if self.priorities else "")
                   for i, (text, medium) in enumerate(zip(self.texts, self.media))]
        lines = ["let starts = [%s]" % ", ".join(text_of(start) for start, _ in self.lines),
                 "let ends = [%s]" % ", ".join(text_of(add(start, direction)) for start, direction in self.lines),
                 "camera { projection = orthographic  from = starts[frame - 1]  to = ends[frame - 1]  up = <.3, .8, .5>  width = 1e-6 }"]
        return "\n".join(["meniscus 1.0 unit cm"] + media + objects + lines + [
            "environment { color = 1 }", "render { bounces = 60000 }", "film { size = <2, 2> }",
            "animation { frames = %d }" % LINES, ""])


def run(meniscus, *arguments):
    return subprocess.run([meniscus, *arguments], capture_output=True, text=True)


def render(meniscus, name, text):
    """False where the scene is refused."""
    with open(name + ".mns", "w") as file:
        file.write(text)
    return run(meniscus, "render", name + ".mns", "-s", "1", "-q", "-o", name + "_####.exr").returncode == 0


def try_scene(meniscus, seed):
    """How many lines agree, and what is wrong; None where the scene is refused."""
    name, scene, n_agree, wrong = "lines%d" % seed, Scene(seed), 0, ""
    if not render(meniscus, name, scene.text()):
        return None
    for i, (start, direction) in enumerate(scene.lines):
        pictures = ["%s_%04d.exr" % (name, i + 1), "empty_%04d.exr" % (i + 1)]  # the wavelengths are the same in both
        means = json.loads(run(meniscus, "compare", *pictures, "--json").stdout)
        left = means["meanA"][1] / means["meanB"][1]
        for steps in (STEPS, FINE_STEPS):
            expected = scene.left_along(start, direction, steps)
            agrees = expected is not None and abs(left - expected) <= ALLOWED * expected
            if agrees or expected is None:
                break
        n_agree += agrees
        if expected is not None and not agrees:
            wrong += "line %d leaves %.6f, not %.6f; " % (i + 1, left, expected)
    return n_agree, wrong


def main():
    meniscus, first, last = os.path.abspath(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    home, n_agree, n_lines, n_failed, n_refused = os.getcwd(), 0, 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        empty = "meniscus 1.0 unit cm\nenvironment { color = 1 }\nfilm { size = <2, 2> }\nanimation { frames = %d }\n"
        render(meniscus, "empty", empty % LINES + "camera { projection = orthographic  from = <0, 0, 9>  width = 1e-6 }\n")
        for seed in range(first, last + 1):
            tried = try_scene(meniscus, seed)
            n_refused += tried is None
            agree, wrong = tried or (0, "")
            n_agree += agree
            n_lines += LINES if tried else 0
            n_failed += bool(wrong)
            if wrong:
                os.replace("lines%d.mns" % seed, os.path.join(home, "lines%d.mns" % seed))
                print("lines%d.mns: %s" % (seed, wrong), flush=True)
        os.chdir(home)
    n_passed = last + 1 - first - n_refused - n_failed
    print("%d of %d lines agree, the order along the others is not known; %d scenes were refused" % (n_agree, n_lines, n_refused))
    print("%d passed, %d failed" % (n_passed, n_failed))
    return n_failed > 0 or n_passed == 0


if __name__ == "__main__":
    sys.exit(main())
