#!/usr/bin/env python3
"""Makes the meshes and the environment image that the larger examples use.

    examples/make-assets.py FOLDER

writes ice1.ply ice2.ply ice3.ply (ice cubes of about 24 units, centred on the origin), water_surface.ply
(the body of water of the aquarium), goby.ply trout.ply tetra.ply angelfish.ply (fish of 6 units that swim towards +x),
spruce1.ply spruce2.ply (trees of 1 unit that stand on the origin), studio.exr (a lat-long environment of soft lights) and label.png
(an oval label, clear around it). The same bytes on every run. Python's standard library is enough.
SPDX-License-Identifier: Apache-2.0
"""

import math
import os
import random
import struct
import sys
import zlib
from array import array


# ---- vectors ----

def normalized(v):
    length = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    return (v[0] / length, v[1] / length, v[2] / length) if length > 0 else (0.0, 1.0, 0.0)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def smoothstep(low, high, x):
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3 - 2 * t)


# ---- meshes ----

class Mesh:
    """Vertices are shared where their key is the same. Triangles are counter-clockwise seen from outside."""

    def __init__(self):
        self.positions, self.normals, self.triangles, self.index_of_key = [], None, [], {}

    def vertex(self, key, position):
        index = self.index_of_key.get(key)
        if index is None:
            index = self.index_of_key[key] = len(self.positions)
            self.positions.append(position() if callable(position) else position)
        return index

    def quad(self, a, b, c, d):
        self.triangles.append((a, b, c))
        self.triangles.append((a, c, d))

    def round_to_float(self):
        """What the file holds is what is checked."""
        flat = array('f', [x for p in self.positions for x in p])
        self.positions = [(flat[i], flat[i + 1], flat[i + 2]) for i in range(0, len(flat), 3)]

    def compute_normals(self):
        """The mean of the triangles' normals around each vertex, by area."""
        sums = [[0.0, 0.0, 0.0] for _ in self.positions]
        for a, b, c in self.triangles:
            p, q, r = self.positions[a], self.positions[b], self.positions[c]
            ux, uy, uz = q[0] - p[0], q[1] - p[1], q[2] - p[2]
            vx, vy, vz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
            nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
            for i in (a, b, c):
                s = sums[i]
                s[0] += nx
                s[1] += ny
                s[2] += nz
        self.normals = [normalized(s) for s in sums]

    def volume(self):
        total = 0.0
        for a, b, c in self.triangles:
            p, q, r = self.positions[a], self.positions[b], self.positions[c]
            total += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2])
                      + p[2] * (q[0] * r[1] - q[1] * r[0]))
        return total / 6

    def check(self, name):
        """By position, because vertices may be split to have normals of their own."""
        number_of_position = {}
        number = [number_of_position.setdefault(p, i) for i, p in enumerate(self.positions)]
        edges = set()
        for a, b, c in self.triangles:
            a, b, c = number[a], number[b], number[c]
            assert a != b and b != c and c != a, name + ': a triangle without area'
            for edge in ((a, b), (b, c), (c, a)):
                assert edge not in edges, name + ': an edge is used twice in one direction'
                edges.add(edge)
        assert all((b, a) in edges for a, b in edges), name + ': an edge is open'
        assert self.volume() > 0, name + ': inside out'

    def write(self, path):
        """Binary little-endian PLY."""
        self.check(os.path.basename(path))
        header = ('ply\nformat binary_little_endian 1.0\n'
                  'element vertex %d\nproperty float x\nproperty float y\nproperty float z\n'
                  'property float nx\nproperty float ny\nproperty float nz\n'
                  'element face %d\nproperty list uchar int vertex_indices\nend_header\n'
                  % (len(self.positions), len(self.triangles)))
        vertices = [x for p, n in zip(self.positions, self.normals) for x in p + n]
        face = struct.Struct('<Biii').pack
        with open(path, 'wb') as out:
            out.write(header.encode())
            out.write(struct.pack('<%df' % len(vertices), *vertices))
            out.write(b''.join([face(3, a, b, c) for a, b, c in self.triangles]))


# ---- ice ----

ICE_HALF = 12.0    # half the side
ICE_CELLS = 68     # per side of a face: 6 * 68 * 68 * 2 = 55,488 triangles


def random_waves(rng, n, low, high, amplitude):
    """n plane waves (wave vector, phase, amplitude) of wave numbers low..high, in radians per unit."""
    waves = []
    for _ in range(n):
        direction = normalized((rng.gauss(0, 1), rng.gauss(0, 1), rng.gauss(0, 1)))
        number = rng.uniform(low, high)
        waves.append((direction[0] * number, direction[1] * number, direction[2] * number,
                      rng.uniform(0, 2 * math.pi), amplitude / math.sqrt(n) * rng.uniform(.6, 1.4)))
    return waves


def sum_of_waves(waves, p):
    x, y, z = p
    return sum([amplitude * math.sin(kx * x + ky * y + kz * z + phase) for kx, ky, kz, phase, amplitude in waves])


class Ice:
    """A rounded cube whose corners have melted, whose faces are dented, and all of it a little wavy."""

    def __init__(self, seed):
        rng = random.Random(seed)
        self.size = [ICE_HALF * rng.uniform(.95, 1.05) for _ in range(3)]
        self.taper = rng.uniform(.03, .07)    # out of a tray: wider at the top
        self.shear = (rng.uniform(-.03, .03), rng.uniform(-.03, .03))
        # how deep each face (-x +x -y +y -z +z) is dented; the top one froze last and may bulge
        self.dents = [rng.uniform(.15, .7) for _ in range(6)]
        self.dents[3] = rng.uniform(-.5, .9)
        self.melt = random_waves(rng, 4, .06, .14, .8)
        self.swell = random_waves(rng, 8, .12, .35, .32)
        self.ripple = random_waves(rng, 12, .7, 1.7, .055)

    def point(self, u, v, w):
        """From the surface of the cube -1..1 to the surface of the ice."""
        cube = (u * self.size[0], v * self.size[1], w * self.size[2])
        radius = 3.4 + sum_of_waves(self.melt, cube)
        core = [min(s - radius, max(radius - s, c)) for c, s in zip(cube, self.size)]
        outward = normalized([c - k for c, k in zip(cube, core)])
        offset = sum_of_waves(self.swell, cube) + sum_of_waves(self.ripple, cube)
        for axis, t in enumerate((u, v, w)):
            a, b = (u, v, w)[axis - 2], (u, v, w)[axis - 1]
            inside = max(0.0, 1 - a * a) * max(0.0, 1 - b * b)
            offset -= self.dents[2 * axis + (t > 0)] * inside * smoothstep(.5, 1, abs(t))
        x, y, z = [k + (radius + offset) * n for k, n in zip(core, outward)]
        widen = 1 + self.taper * y / ICE_HALF
        return (x * widen + self.shear[0] * y, y, z * widen + self.shear[1] * y)


def steps_across(n):
    """n + 1 values of -1..1, a little denser in the middle, as the rounding draws the outer ones apart."""
    inner = [2 * i / n - 1 for i in range(1, n)]
    return [-1.0] + [.35 * math.tan(.62 * t) / math.tan(.62) + .65 * t for t in inner] + [1.0]


def make_ice(seed):
    ice, mesh, n = Ice(seed), Mesh(), ICE_CELLS
    steps = steps_across(n)

    def corner(axis, side, i, j):
        key = [0, 0, 0]
        key[axis], key[axis - 2], key[axis - 1] = side * n, i, j
        return mesh.vertex(tuple(key), lambda: ice.point(steps[key[0]], steps[key[1]], steps[key[2]]))

    for axis in range(3):
        for side in (0, 1):
            for i in range(n):
                for j in range(n):
                    quad = [corner(axis, side, i, j), corner(axis, side, i + 1, j),
                            corner(axis, side, i + 1, j + 1), corner(axis, side, i, j + 1)]
                    mesh.quad(*(quad if side else quad[::-1]))
    mesh.round_to_float()
    mesh.compute_normals()
    return mesh


# ---- water ----

WATER_FROM, WATER_TO = (-50.1, -0.05, -25.1), (50.1, 40.0, 25.1)
WATER_CELLS = (180, 90)
WATER_ROWS = 8


def water_waves():
    rng = random.Random(40)
    waves = []
    for i in range(7):
        number = .13 * 1.45 ** i
        angle = rng.uniform(-1.1, 1.1)
        waves.append((number * math.cos(angle), number * math.sin(angle), rng.uniform(0, 2 * math.pi), .17 / 1.35 ** i))
    return waves


def make_water():
    """A box with a wavy top. Every side has its own vertices at the rims, so that only the top is smooth."""
    mesh, waves = Mesh(), water_waves()
    nx, nz = WATER_CELLS
    xs = [WATER_FROM[0] + (WATER_TO[0] - WATER_FROM[0]) * i / nx for i in range(nx)] + [WATER_TO[0]]
    zs = [WATER_FROM[2] + (WATER_TO[2] - WATER_FROM[2]) * j / nz for j in range(nz)] + [WATER_TO[2]]
    bottom = WATER_FROM[1]
    height = [[WATER_TO[1] + sum([a * math.sin(kx * x + kz * z + phase) for kx, kz, phase, a in waves]) for z in zs]
              for x in xs]
    normals = {}

    def slope_normal(i, j):
        dx = sum([a * kx * math.cos(kx * xs[i] + kz * zs[j] + phase) for kx, kz, phase, a in waves])
        dz = sum([a * kz * math.cos(kx * xs[i] + kz * zs[j] + phase) for kx, kz, phase, a in waves])
        return normalized((-dx, 1.0, -dz))

    def corner(side, i, j, row):
        y = height[i][j] if row == WATER_ROWS else bottom + (height[i][j] - bottom) * row / WATER_ROWS
        index = mesh.vertex((side, i, j, row), (xs[i], y, zs[j]))
        if index not in normals:
            normals[index] = slope_normal(i, j) if side == (0, 1, 0) else tuple(map(float, side))
        return index

    for i in range(nx):
        for j in range(nz):
            for side, row in (((0, 1, 0), WATER_ROWS), ((0, -1, 0), 0)):
                quad = [corner(side, i, j, row), corner(side, i, j + 1, row),
                        corner(side, i + 1, j + 1, row), corner(side, i + 1, j, row)]
                mesh.quad(*(quad if row else quad[::-1]))
    for row in range(WATER_ROWS):
        for side, run in (((0, 0, -1), [(i, 0) for i in range(nx + 1)]),
                          ((1, 0, 0), [(nx, j) for j in range(nz + 1)]),
                          ((0, 0, 1), [(i, nz) for i in range(nx, -1, -1)]),
                          ((-1, 0, 0), [(0, j) for j in range(nz, -1, -1)])):
            for (i, j), (k, l) in zip(run, run[1:]):
                mesh.quad(corner(side, i, j, row), corner(side, i, j, row + 1),
                          corner(side, k, l, row + 1), corner(side, k, l, row))
    mesh.round_to_float()
    mesh.normals = [normals[i] for i in range(len(mesh.positions))]
    return mesh


# ---- fish ----

# along the fish, nose first: x, half height, half width, height of the middle
GOBY_SECTIONS = [(3.0, .0, .0, -.05), (2.93, .22, .26, -.04), (2.75, .40, .46, -.02), (2.4, .58, .62, .02),
                 (1.9, .68, .66, .04), (1.2, .70, .60, .03), (.4, .64, .50, .0), (-.6, .50, .34, -.01),
                 (-1.3, .36, .20, .0), (-1.75, .30, .12, .01), (-2.05, .42, .06, .02), (-2.4, .66, .04, .03),
                 (-2.75, .78, .03, .03), (-2.93, .72, .025, .03), (-3.0, .55, .02, .03)]
GOBY_RINGS = 96


def goby_section(t):
    """Catmull-Rom through the table; t runs from 0 at the nose to 1 at the tail."""
    s = t * (len(GOBY_SECTIONS) - 1)
    i = min(int(s), len(GOBY_SECTIONS) - 2)
    f = s - i
    rows = [GOBY_SECTIONS[min(max(i + k, 0), len(GOBY_SECTIONS) - 1)] for k in (-1, 0, 1, 2)]
    return [b + .5 * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a)))
            for a, b, c, d in zip(*rows)]


def goby_angles():
    """Around a section from the back, denser where the fins grow: at the top, the bottom and the flanks."""
    steps = [0, .02, .04, .06, .08, .11, .15, .25, .4, .6, .8, 1.0, 1.15, 1.28, 1.36, 1.43, 1.5, 1.57, 1.64, 1.71, 1.78,
             1.86, 2.0, 2.2, 2.45, 2.7, 2.88, 2.98, 3.03, 3.06, 3.08, 3.1, 3.12]
    return steps + [math.pi] + [2 * math.pi - a for a in steps[:0:-1]]


def fin(x, tail, nose, height):
    """A fin's height over its base: a steep front edge and a long slope back."""
    if not tail < x < nose:
        return 0.0
    t = (nose - x) / (nose - tail)
    return height * smoothstep(0, .3, t) * (1 - smoothstep(.55, 1, t)) * (1 - .25 * t)


def goby_point(t, angle):
    x, half_height, half_width, middle = goby_section(t)
    up, side = math.cos(angle), math.sin(angle)
    y, z = middle + half_height * up, half_width * side
    from_top, from_bottom = min(angle, 2 * math.pi - angle), abs(math.pi - angle)
    ridge, keel = 1 - smoothstep(.02, .13, from_top), 1 - smoothstep(.02, .13, from_bottom)
    y += ridge * (fin(x, .35, 1.55, .62) + fin(x, -1.6, .25, .48)) - keel * fin(x, -1.6, -.1, .38)
    flank = min(abs(angle - 1.57), abs(angle - 2 * math.pi + 1.57))
    breast = (1 - smoothstep(.05, .28, flank)) * fin(x, .9, 1.75, 1.0)
    sign = 1 if side > 0 else -1
    eye = math.exp(-((x - 2.42) ** 2 + (y - .34) ** 2) / .022)
    return (x - .75 * breast, y - .2 * breast + .10 * eye, z + sign * (.62 * breast + .10 * eye))


def make_goby():
    mesh, angles, n = Mesh(), goby_angles(), GOBY_RINGS
    m = len(angles)
    nose, tail = GOBY_SECTIONS[0], GOBY_SECTIONS[-1]

    def corner(ring, k):
        if ring == 0:
            return mesh.vertex('nose', (nose[0], nose[3], 0.0))
        t = (ring / n) ** 1.15
        return mesh.vertex((ring, k % m), lambda: goby_point(t, angles[k % m]))

    end = mesh.vertex('tail', (tail[0] - .01, tail[3], 0.0))
    for k in range(m):
        mesh.triangles.append((corner(0, 0), corner(1, k), corner(1, k + 1)))
        mesh.triangles.append((end, corner(n, k + 1), corner(n, k)))
        for ring in range(1, n):
            mesh.quad(corner(ring, k), corner(ring + 1, k), corner(ring + 1, k + 1), corner(ring, k + 1))
    mesh.round_to_float()
    mesh.compute_normals()
    return mesh


# ---- trout, tetras, angelfish ----

# along the body and the tail fin, nose first: x, half height, half width, height of the middle
TROUT_SECTIONS = [(3.0, .0, .0, -.06), (2.95, .11, .10, -.06), (2.8, .22, .18, -.05), (2.5, .36, .29, -.03),
                  (2.0, .50, .37, .0), (1.3, .61, .42, .0), (.5, .64, .42, .0), (-.3, .58, .36, .0),
                  (-1.0, .45, .27, .02), (-1.6, .30, .17, .03), (-2.0, .22, .10, .03), (-2.2, .23, .065, .03),
                  (-2.45, .38, .035, .03), (-2.7, .56, .022, .03), (-2.93, .68, .014, .03), (-3.0, .69, .008, .03)]
# fins, in the order front of the base, back of the base, front and back of the rim; z is doubled to both flanks
TROUT_FINS = [((.95, .50, 0), (-.40, .48, 0), (.45, 1.08, 0), (-.62, .80, 0)),            # on the back
              ((-1.30, .30, 0), (-1.55, .24, 0), (-1.62, .54, 0), (-1.72, .46, 0)),       # the small one behind it
              ((-.85, -.36, 0), (-1.40, -.26, 0), (-1.28, -.84, 0), (-1.62, -.52, 0)),    # under the tail
              ((1.85, -.33, .24), (1.55, -.42, .24), (1.15, -.62, .82), (.90, -.62, .55)),   # behind the gills
              ((.10, -.52, .14), (-.22, -.50, .14), (-.45, -.82, .42), (-.66, -.72, .28))]   # at the belly

# small and slender, with a forked tail
TETRA_SECTIONS = [(3.0, .0, .0, .0), (2.93, .15, .13, .0), (2.7, .33, .24, .02), (2.3, .52, .34, .04), (1.6, .70, .38, .03),
                  (.8, .76, .36, .0), (.0, .68, .30, .0), (-.8, .50, .20, .02), (-1.4, .33, .12, .04), (-1.75, .26, .08, .05),
                  (-1.95, .28, .05, .05), (-2.2, .50, .03, .05), (-2.6, .86, .018, .05), (-2.9, 1.10, .01, .05),
                  (-3.0, 1.14, .008, .05)]
TETRA_FINS = [((.75, .70, 0), (.0, .62, 0), (.05, 1.50, 0), (-.55, 1.15, 0)),
              ((-.95, .44, 0), (-1.15, .38, 0), (-1.30, .62, 0), (-1.38, .52, 0)),
              ((.0, -.60, 0), (-1.25, -.32, 0), (-.35, -1.30, 0), (-1.55, -.62, 0)),
              ((1.75, -.30, .32), (1.55, -.36, .32), (1.05, -.66, .72), (.92, -.50, .60)),
              ((.85, -.70, .12), (.60, -.68, .12), (.30, -1.15, .34), (.15, -1.0, .24))]

# a thin, high disc, whose fins sweep back above and below
ANGEL_SECTIONS = [(3.0, .0, .0, -.05), (2.92, .16, .12, -.04), (2.65, .48, .24, .0), (2.2, .95, .36, .04), (1.5, 1.55, .44, .05),
                  (.6, 1.92, .42, .03), (-.2, 1.80, .34, .0), (-.9, 1.25, .22, .0), (-1.35, .70, .13, .0), (-1.6, .48, .08, .0),
                  (-1.8, .50, .05, .0), (-2.1, .70, .03, .0), (-2.6, .98, .018, .0), (-2.9, 1.14, .01, .0), (-3.0, 1.16, .008, .0)]
ANGEL_FINS = [((1.1, 1.68, 0), (-1.30, .66, 0), (-1.9, 4.3, 0), (-2.0, 1.25, 0)),
              ((.9, -1.74, 0), (-1.30, -.66, 0), (-2.3, -4.7, 0), (-2.1, -1.30, 0)),
              ((1.55, -.25, .42), (1.30, -.45, .42), (.70, -.75, .80), (.60, -.35, .70)),
              ((1.45, -1.50, .10), (1.27, -1.58, .10), (.55, -4.30, .30), (.45, -4.25, .30))]


class Fish:
    """6 long. As it swims, the tail strikes out farthest, by `stroke`; the tail fin is forked by `fork`."""

    def __init__(self, sections, fins, eye, stroke, fork, rings, angles):
        self.sections, self.fins, self.eye, self.stroke, self.fork = sections, fins, eye, stroke, fork
        self.rings, self.angles = rings, angles

    def bend(self, x, y, z):
        return (x, y, z + self.stroke * (.06 + .0135 * (3 - x) ** 2) * math.sin(.95 * x - .3))

    def body(self, t, angle):
        rows = self.sections
        s = t * (len(rows) - 1)
        i = min(int(s), len(rows) - 2)
        f = s - i
        rows = [rows[min(max(i + k, 0), len(rows) - 1)] for k in (-1, 0, 1, 2)]
        x, half_height, half_width, middle = [
            b + .5 * f * (c - a + f * (2 * a - 5 * b + 4 * c - d + f * (3 * (b - c) + d - a))) for a, b, c, d in zip(*rows)]
        up, side = math.cos(angle), math.sin(angle)
        y, z = middle + half_height * up, half_width * side
        eye = math.exp(-((x - self.eye[0]) ** 2 + (y - self.eye[1]) ** 2) / .012)
        forked = self.fork * smoothstep(-2.25, -3, x) * (1 - abs(up)) ** 1.3
        return self.bend(x + forked, y, z + math.copysign(.05 * eye, side))

    def make(self):
        """A body, and fins that stand in it; fins are as thin as paper at their rims, and closed."""
        mesh, n, m = Mesh(), self.rings, self.angles
        nose, tail = self.sections[0], self.sections[-1]

        def corner(ring, k):
            if ring == 0:
                return mesh.vertex('nose', self.bend(nose[0], nose[3], 0.0))
            return mesh.vertex((ring, k % m), lambda: self.body((ring / n) ** 1.1, 2 * math.pi * (k % m) / m))

        end = mesh.vertex('tail', self.bend(tail[0] + self.fork - .02, tail[3], 0.0))
        for k in range(m):
            mesh.triangles.append((corner(0, 0), corner(1, k), corner(1, k + 1)))
            mesh.triangles.append((end, corner(n, k + 1), corner(n, k)))
            for ring in range(1, n):
                mesh.quad(corner(ring, k), corner(ring + 1, k), corner(ring + 1, k + 1), corner(ring, k + 1))
        nu, nv = 16, 12
        for number, (a, b, c, d) in enumerate(self.fins):
            for flank in ((1, -1) if a[2] else (1,)):
                out = normalized(cross([q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]))

                def rim(i, j, side):
                    u, v = i / nu, j / nv
                    inner = 0 < i < nu and 0 < j < nv
                    high = v * (1 - .12 * (2 * u - 1) ** 4 + .08 * math.sin(math.pi * u))
                    thick = side * .03 * math.sin(math.pi * u) ** .5 * (v * (1 - v) * (2 - v)) ** .5 if inner else 0
                    base, top = [p + (q - p) * u for p, q in zip(a, b)], [p + (q - p) * u for p, q in zip(c, d)]
                    x, y, z = [p + (q - p) * high + o * thick for p, q, o in zip(base, top, out)]
                    return mesh.vertex((number, flank, i, j, side if inner else 0), lambda: self.bend(x, y, z * flank))

                for side in (1, -1):
                    for i in range(nu):
                        for j in range(nv):
                            quad = [rim(i, j, side), rim(i + 1, j, side), rim(i + 1, j + 1, side), rim(i, j + 1, side)]
                            mesh.quad(*(quad if side * flank > 0 else quad[::-1]))
        mesh.round_to_float()
        mesh.compute_normals()
        return mesh


TROUT = Fish(TROUT_SECTIONS, TROUT_FINS, (2.50, .09), 1, .42, 120, 44)
TETRA = Fish(TETRA_SECTIONS, TETRA_FINS, (2.45, .10), .6, .50, 72, 32)
ANGEL = Fish(ANGEL_SECTIONS, ANGEL_FINS, (2.25, .22), .4, .12, 96, 48)


# ---- spruces ----

def make_spruce(seed):
    """A spruce of height 1: a trunk and boughs that droop, of twigs that are pyramids with three sides."""
    rng, mesh = random.Random(seed), Mesh()

    def pyramid(key, base, tip):
        a, b, c, d = [mesh.vertex((key, i), p) for i, p in enumerate(base + [tip])]
        p, q, r, s = base + [tip]
        e, f, g = [[w - v for v, w in zip(p, o)] for o in (q, r, s)]
        if sum([v * w for v, w in zip(cross(e, f), g)]) > 0:
            b, c = c, b
        mesh.triangles.extend([(a, b, c), (a, c, d), (c, b, d), (b, a, d)])

    top, bottom = mesh.vertex('top', (0.0, 1.0, 0.0)), mesh.vertex('bottom', (0.0, -.05, 0.0))
    foot = [mesh.vertex(('foot', k), (.014 * math.cos(math.pi * k / 4), -.05, .014 * math.sin(math.pi * k / 4)))
            for k in range(8)]
    for k in range(8):
        mesh.triangles.extend([(foot[k - 1], top, foot[k]), (foot[k], bottom, foot[k - 1])])
    levels = 40
    for level in range(levels):
        height = .05 + .94 * (level / levels) ** .95
        n = 9 if height < .7 else 7 if height < .9 else 5
        for bough in range(n):
            angle = 2 * math.pi * (bough + .8 * rng.random()) / n + 2.4 * level
            reach = (.175 * (1 - height) ** .85 + .008) * rng.uniform(.62, 1.12) * smoothstep(-.25, .15, height)
            start = height + .012 * rng.uniform(-1, 1)
            droop = rng.uniform(.35, .65)
            out, across = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))

            def along(t):
                return (out[0] * reach * t, start - reach * droop * (1.5 * t - .8 * t * t), out[1] * reach * t)

            steps = 4 if reach < .04 else 7
            for step in range(steps):
                t = (step + .6) / steps
                p, q = along(t - .55 / steps), along(t + .55 / steps)
                for side in (-1, 1):
                    length = reach * (.50 - .30 * t) * rng.uniform(.7, 1.2) + .006
                    ahead, down = rng.uniform(.5, .9), rng.uniform(.15, .55)
                    tip = (q[0] + length * (ahead * out[0] + side * across[0]), q[1] - length * down,
                           q[2] + length * (ahead * out[1] + side * across[1]))
                    over = (.5 * (p[0] + q[0]), .5 * (p[1] + q[1]) + .10 * length + .003, .5 * (p[2] + q[2]))
                    foot = [(x + .001 * side * across[0], y, z + .001 * side * across[1]) for x, y, z in (p, q, over)]
                    pyramid((level, bough, step, side), foot, tip)
            p, q = along(.8), along(1.0)
            foot = [(p[0] + .004, p[1], p[2]), (p[0] - .004, p[1], p[2] + .004), (p[0], p[1] + .004, p[2] - .004)]
            pyramid((level, bough, 'end'), foot,
                    (q[0] + .2 * (q[0] - p[0]), q[1] + .3 * (q[1] - p[1]) + .002, q[2] + .2 * (q[2] - p[2])))
    mesh.round_to_float()
    mesh.compute_normals()
    return mesh


# ---- studio ----

STUDIO_SIZE = (1024, 512)


class Light:
    """A rectangle with soft edges, seen from the origin: half sizes and softness are tangents."""

    def __init__(self, toward, half_width, half_height, softness, color):
        self.axis = normalized(toward)
        self.right = normalized(cross((0, 1, 0), self.axis))
        self.up = cross(self.axis, self.right)
        self.half_width, self.half_height, self.softness, self.color = half_width, half_height, softness, color
        self.reach = math.cos(math.atan(math.hypot(half_width + softness, half_height + softness)))

    def coverage(self, x, y, z):
        ahead = self.axis[0] * x + self.axis[1] * y + self.axis[2] * z
        if ahead < self.reach:
            return 0.0
        across = abs(self.right[0] * x + self.right[1] * y + self.right[2] * z) / ahead
        along = abs(self.up[0] * x + self.up[1] * y + self.up[2] * z) / ahead
        soft = self.softness
        return ((1 - smoothstep(self.half_width - soft, self.half_width + soft, across))
                * (1 - smoothstep(self.half_height - soft, self.half_height + soft, along)))


STUDIO_LIGHTS = [Light((-.80, .55, -.30), .52, .40, .07, (12.0, 11.6, 10.9)),   # key, upper left
                 Light((.92, .12, .36), .075, .85, .035, (7.6, 7.9, 8.4)),       # strip, right
                 Light((.10, .75, .65), .9, .5, .35, (.85, .88, .95))]           # fill, behind and above


def studio_surroundings(y):
    """Warm grey walls, lighter towards the horizon; a darker floor."""
    wall = .10 + .16 * math.exp(-3.0 * abs(y)) + .05 * max(y, 0.0)
    floor = smoothstep(.04, -.10, y)
    wall *= 1 - .72 * floor
    return (wall * 1.06, wall, wall * .92)


def studio_row(j):
    """Half floats of one row, channel after channel in the order of the file: B, G, R."""
    width, height = STUDIO_SIZE
    elevation = math.pi * (.5 - (j + .5) / height)
    y, ring = math.sin(elevation), math.cos(elevation)
    base = studio_surroundings(y)
    lights = [light for light in STUDIO_LIGHTS
              if math.cos(elevation - math.asin(light.axis[1])) >= light.reach]
    channels = [[base[2]] * width, [base[1]] * width, [base[0]] * width]
    for i in range(width if lights else 0):
        azimuth = 2 * math.pi * ((i + .5) / width - .5)
        x, z = ring * math.sin(azimuth), -ring * math.cos(azimuth)
        for light in lights:
            coverage = light.coverage(x, y, z)
            if coverage > 0:
                for channel, color in zip(channels, reversed(light.color)):
                    channel[i] += coverage * color
    return struct.pack('<%de' % (3 * width), *(channels[0] + channels[1] + channels[2]))


def exr_attribute(name, kind, value):
    return name.encode() + b'\0' + kind.encode() + b'\0' + struct.pack('<i', len(value)) + value


def write_studio(path):
    """A scan-line EXR without compression."""
    width, height = STUDIO_SIZE
    half = 1
    channels = b''.join(name + b'\0' + struct.pack('<iB3xii', half, 0, 1, 1) for name in (b'B', b'G', b'R')) + b'\0'
    window = struct.pack('<4i', 0, 0, width - 1, height - 1)
    header = struct.pack('<II', 20000630, 2) + b''.join([
        exr_attribute('channels', 'chlist', channels),
        exr_attribute('chromaticities', 'chromaticities', struct.pack('<8f', .64, .33, .3, .6, .15, .06, .3127, .329)),
        exr_attribute('compression', 'compression', b'\0'),
        exr_attribute('dataWindow', 'box2i', window),
        exr_attribute('displayWindow', 'box2i', window),
        exr_attribute('envmap', 'envmap', b'\0'),
        exr_attribute('lineOrder', 'lineOrder', b'\0'),
        exr_attribute('pixelAspectRatio', 'float', struct.pack('<f', 1)),
        exr_attribute('screenWindowCenter', 'v2f', struct.pack('<2f', 0, 0)),
        exr_attribute('screenWindowWidth', 'float', struct.pack('<f', 1)),
    ]) + b'\0'
    row_bytes = 6 * width
    first = len(header) + 8 * height
    offsets = struct.pack('<%dQ' % height, *[first + j * (8 + row_bytes) for j in range(height)])
    with open(path, 'wb') as out:
        out.write(header + offsets)
        for j in range(height):
            out.write(struct.pack('<ii', j, row_bytes) + studio_row(j))


# ---- a label ----

LABEL_WIDTH, LABEL_HEIGHT = 512, 320

# Strokes of letters in a box of 1 by 1.4.
LETTERS = {
    'M': [(0, 0, 0, 1.4), (0, 1.4, .5, .6), (.5, .6, 1, 1.4), (1, 1.4, 1, 0)],
    'E': [(0, 0, 0, 1.4), (0, 0, .85, 0), (0, .72, .7, .72), (0, 1.4, .85, 1.4)],
    'N': [(0, 0, 0, 1.4), (0, 1.4, 1, 0), (1, 0, 1, 1.4)],
    'I': [(.5, 0, .5, 1.4)],
    'S': [(0, .1, .25, 0), (.25, 0, .7, 0), (.7, 0, .95, .2), (.95, .2, .95, .5), (.95, .5, .7, .7), (.7, .7, .3, .7),
          (.3, .7, .05, .9), (.05, .9, .05, 1.2), (.05, 1.2, .3, 1.4), (.3, 1.4, .75, 1.4), (.75, 1.4, .95, 1.3)],
    'C': [(1, .25, .7, 0), (.7, 0, .3, 0), (.3, 0, 0, .3), (0, .3, 0, 1.1), (0, 1.1, .3, 1.4), (.3, 1.4, .7, 1.4),
          (.7, 1.4, 1, 1.15)],
    'U': [(0, 1.4, 0, .3), (0, .3, .3, 0), (.3, 0, .7, 0), (.7, 0, 1, .3), (1, .3, 1, 1.4)],
}


def stroke_distance(x, y, stroke):
    ax, ay, bx, by = stroke
    dx, dy = bx - ax, by - ay
    t = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
    return math.hypot(x - ax - t * dx, y - ay - t * dy)


def text_distance(word, size, pitch, x, y):
    """From the middle of the word at the origin, in pixels; far away it is only a bound."""
    width = (len(word) - 1) * pitch + size
    k = int(math.floor((x + width / 2 + (pitch - size) / 2) / pitch))
    if k < 0 or k >= len(word) or abs(y) > size * 1.2:
        return 1e3
    u, v = (x + width / 2 - k * pitch) / size, y / size + .7
    return size * min(stroke_distance(u, v, stroke) for stroke in LETTERS[word[k]])


def label_pixel(column, row):
    x, y = column + .5 - LABEL_WIDTH / 2, LABEL_HEIGHT / 2 - row - .5
    oval = 1 - math.hypot(x / (LABEL_WIDTH / 2 - 4), y / (LABEL_HEIGHT / 2 - 4))
    edge = oval * LABEL_HEIGHT / 2
    paper, ink, red = (244, 234, 208), (46, 38, 60), (160, 30, 36)
    drop = math.hypot(x, y - 62 + max(0.0, y - 62) * .45) if y < 62 else math.hypot(x * (1 + (y - 62) / 26), (y - 62) * .62)
    layers = [
        (red, 3.5 - abs(edge - 12)), (ink, 1.2 - abs(edge - 20)),
        (red, 17 - drop), (ink, 4.2 - text_distance('MENISCUS', 30, 44, x, y + 12)),
        (ink, 1.2 - abs(y + 54) if abs(x) < 120 else -1), (red, 2.6 - text_distance('NUCIS', 20, 31, x, y + 86)),
    ]
    color = paper
    for layer, inside in layers:
        part = smoothstep(-.7, .7, inside)
        color = tuple(a + (b - a) * part for a, b in zip(color, layer))
    return [int(c + .5) for c in color] + [int(255 * smoothstep(-.7, .7, edge) + .5)]


def png_chunk(kind, body):
    return struct.pack('>I', len(body)) + kind + body + struct.pack('>I', zlib.crc32(kind + body))


def write_label(path):
    rows = b''.join(b'\0' + bytes(b for column in range(LABEL_WIDTH) for b in label_pixel(column, row))
                    for row in range(LABEL_HEIGHT))
    with open(path, 'wb') as out:
        out.write(b'\x89PNG\r\n\x1a\n')
        out.write(png_chunk(b'IHDR', struct.pack('>IIBBBBB', LABEL_WIDTH, LABEL_HEIGHT, 8, 6, 0, 0, 0)))
        out.write(png_chunk(b'IDAT', zlib.compress(rows, 9)))
        out.write(png_chunk(b'IEND', b''))


def write_cut(path):
    """The cutting instructions of a standard brilliant by Tolkowsky's proportions, as GemCad writes them: half of its width is 1."""
    table, crown, pavilion, star, lower_half, girdle = .53, math.radians(34.5), math.radians(40.75), .5, .77, .03

    def ring(n, radius, height, turn=0):
        return [(radius * math.sin(turn + 2 * math.pi * k / n), height, radius * math.cos(turn + 2 * math.pi * k / n))
                for k in range(n)]

    def tier(name, a, b, c, mirrored=False):
        """The facets that are one of eight with the corners a, b, c, or with their mirror images."""
        normal = normalized(cross([q - p for p, q in zip(a, b)], [q - p for p, q in zip(a, c)]))
        distance = sum(n * p for n, p in zip(normal, a))
        if distance < 0:
            normal, distance = [-n for n in normal], -distance
        angle = math.copysign(math.degrees(math.acos(abs(normal[1]))), normal[1])
        first = 96 * math.atan2(normal[0], normal[2]) / (2 * math.pi)
        teeth = sorted({round(side * first + 12 * k) % 96 or 96 for k in range(8) for side in ((1, -1) if mirrored else (1,))})
        return 'a %.8f %.10f %d n %s %s' % (angle, distance, teeth[0], name, ' '.join(map(str, teeth[1:])))

    tip = table * math.cos(math.pi / 8) + star * (1 - table * math.cos(math.pi / 8))
    height = girdle + (1 - table) * math.tan(crown)
    tables = ring(8, table, height)
    stars = ring(8, tip, girdle + (1 - tip * math.cos(math.pi / 8)) * math.tan(crown), math.pi / 8)
    above, below = ring(16, 1, girdle), ring(16, 1, 0)
    halves = ring(8, 1 - lower_half, -(1 - (1 - lower_half) * math.cos(math.pi / 8)) * math.tan(pavilion), math.pi / 8)
    lines = ['GemCad 5.0', 'g 96 0.0', 'y 8 y', 'I 2.417', 'H Standard brilliant, 57 facets and 16 on the girdle',
             tier('P1', (0, -math.tan(pavilion), 0), halves[0], halves[7]), tier('P2', below[1], below[2], halves[0], True),
             'a 90.0 %.10f %s' % (math.cos(math.pi / 16), ' '.join(str(3 + 6 * k) for k in range(16))),
             tier('C1', tables[0], above[0], stars[0]), tier('C2', stars[0], above[1], above[2], True),
             tier('S', tables[0], tables[1], stars[0]), 'a 0.0 %.10f' % height, 'F M. Tolkowsky, Diamond Design, 1919']
    with open(path, 'w', newline='') as out:
        out.write('\r\n'.join(lines) + '\r\n')


def main():
    if len(sys.argv) != 2:
        sys.exit('usage: make-assets.py FOLDER')
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    for i in (1, 2, 3):
        make_ice(i).write(os.path.join(folder, 'ice%d.ply' % i))
    make_water().write(os.path.join(folder, 'water_surface.ply'))
    make_goby().write(os.path.join(folder, 'goby.ply'))
    for name, fish in (('trout', TROUT), ('tetra', TETRA), ('angelfish', ANGEL)):
        fish.make().write(os.path.join(folder, name + '.ply'))
    for i in (1, 2):
        make_spruce(i).write(os.path.join(folder, 'spruce%d.ply' % i))
    write_cut(os.path.join(folder, 'brilliant.asc'))
    write_label(os.path.join(folder, 'label.png'))
    write_studio(os.path.join(folder, 'studio.exr'))


if __name__ == '__main__':
    main()
