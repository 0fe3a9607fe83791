#!/usr/bin/env python3
"""The scene that renderers are compared on: a glass with a drink, ice and bubbles on a table, all of triangles.

usage: glass.py FOLDER     writes glass.mns and its meshes there; with PEERS_GREY=1 in the environment all is grey

The same triangles for all: hulls() are closed bodies that overlap, as meniscus takes them; borders() is what a renderer
needs that knows nothing of nesting: every border between two media once, cut by hand. Both are made from the same
outlines, so that they are one scene. The drink's hull reaches into the glass, the ice stands half out of the drink.
SPDX-License-Identifier: Apache-2.0
"""
import math
import os
import random
import sys

SIZE = 240
BOUNCES = 64
AROUND = 54          # corners of everything that is turned
LEVEL = 50.0         # of the drink
CLIMB = 1.8          # how far it climbs the wall
OVERLAP = 0.1        # how far the drink's hull reaches into the glass
FLAT = 27.0          # within this radius the drink's surface is flat: there the ice stands
TABLE_Y, TABLE_HALF, TABLE_ALBEDO = -0.5, 260.0, (0.62, 0.55, 0.47)
LAMP = {"from": (-190.0, 330.0, 130.0), "to": (0.0, 40.0, 0.0), "size": 140.0, "radiance": 12.0}
SKY = (0.55, 0.65, 0.8)
CAMERA = {"from": (0.0, 135.0, 330.0), "to": (0.0, 42.0, 0.0), "fov": 18.0}
MEDIA = {  # index, absorption per mm of red, green and blue
    "air": (1.0, (0.0, 0.0, 0.0)),
    "glass": (1.52, (0.0009, 0.0004, 0.0006)),
    "drink": (1.36, (0.004, 0.03, 0.16)),
    "ice": (1.31, (0.0004, 0.00008, 0.00003)),
}
# Without colours a renderer by three colours and one by wavelengths must make the same picture.
if os.environ.get("PEERS_GREY"):
    MEDIA = {name: (ior, (sum(sigma) / 3,) * 3) for name, (ior, sigma) in MEDIA.items()}
    TABLE_ALBEDO, SKY = (0.55,) * 3, (0.65,) * 3


# ---- small geometry ----

def sub(a, b): return (a[0] - b[0], a[1] - b[1], a[2] - b[2])
def add(a, b): return (a[0] + b[0], a[1] + b[1], a[2] + b[2])
def scaled(a, s): return (a[0] * s, a[1] * s, a[2] * s)
def dot(a, b): return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
def cross(a, b): return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
def unit(a): return scaled(a, 1 / math.sqrt(dot(a, a)))


class Mesh:
    def __init__(self, vertices=(), triangles=()):
        self.vertices, self.triangles = list(vertices), list(triangles)

    def join(self, other):
        n = len(self.vertices)
        self.vertices += other.vertices
        self.triangles += [(a + n, b + n, c + n) for a, b, c in other.triangles]
        return self

    def welded(self):
        """The same with one vertex at each place; a place is known by its bits in float."""
        numbers, vertices, moved = {}, [], []
        for v in self.vertices:
            key = tuple(round(c, 6) + 0.0 for c in v)
            if key not in numbers:
                numbers[key] = len(vertices)
                vertices.append(key)
            moved.append(numbers[key])
        triangles = [tuple(moved[i] for i in t) for t in self.triangles]
        return Mesh(vertices, [t for t in triangles if len(set(t)) == 3])


def rounded(corners, step=math.radians(15)):
    """An outline of (r, y, radius): its corners replaced by arcs."""
    points = []
    for i, (r, y, radius) in enumerate(corners):
        if not radius:
            points.append((r, y))
            continue
        (ar, ay, _), (br, by, _) = corners[i - 1], corners[i + 1]
        da, db = math.hypot(ar - r, ay - y), math.hypot(br - r, by - y)
        a, b = ((ar - r) / da, (ay - y) / da), ((br - r) / db, (by - y) / db)
        half = math.acos(max(-1, min(1, a[0] * b[0] + a[1] * b[1]))) / 2
        middle = (a[0] + b[0], a[1] + b[1])
        length = math.hypot(*middle)
        centre = (r + middle[0] / length * radius / math.sin(half), y + middle[1] / length * radius / math.sin(half))
        cut = radius / math.tan(half)
        start, end = (r + a[0] * cut, y + a[1] * cut), (r + b[0] * cut, y + b[1] * cut)
        first = math.atan2(start[1] - centre[1], start[0] - centre[0])
        turn = math.remainder(math.atan2(end[1] - centre[1], end[0] - centre[0]) - first, 2 * math.pi)
        n = max(1, math.ceil(abs(turn) / step))
        points += [(centre[0] + radius * math.cos(first + turn * k / n), centre[1] + radius * math.sin(first + turn * k / n))
                   for k in range(n + 1)]
    return points


def turned(outline):
    """An outline turned about y; walking along it the outside is on the right."""
    mesh = Mesh()
    for r, y in outline:
        mesh.vertices += [(r * math.cos(2 * math.pi * k / AROUND), y, -r * math.sin(2 * math.pi * k / AROUND))
                          for k in range(AROUND)]
    for i in range(len(outline) - 1):
        for k in range(AROUND):
            a, b = i * AROUND + k, i * AROUND + (k + 1) % AROUND
            if outline[i][0] > 0:
                mesh.triangles.append((a, b, b + AROUND))
            if outline[i + 1][0] > 0:
                mesh.triangles.append((a, b + AROUND, a + AROUND))
    return mesh.welded()


def ball(centre, radius):
    """An icosahedron, its 20 faces split in four."""
    g = (1 + math.sqrt(5)) / 2
    vertices = [unit(v) for v in ((-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
                                  (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1))]
    faces = ((0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1))
    mesh = Mesh()
    for face in faces:
        a, b, c = (vertices[i] for i in face)
        ab, bc, ca = unit(add(a, b)), unit(add(b, c)), unit(add(c, a))
        for triangle in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)):
            n = len(mesh.vertices)
            mesh.vertices += [add(centre, scaled(v, radius)) for v in triangle]
            mesh.triangles.append((n, n + 1, n + 2))
    return mesh.welded()


def ice_cube(half, rounding, n, place):
    """A box with rounded edges: what a grid on a cube's faces becomes."""
    mesh = Mesh()
    steps = [math.tan(math.pi / 4 * (2 * i / n - 1)) for i in range(n + 1)]
    for axis in range(3):
        for side in (-1, 1):
            first = len(mesh.vertices)
            for v in steps:
                for u in steps:
                    p = [0, 0, 0]
                    p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3] = side, u, v
                    core = tuple(max(rounding - half, min(half - rounding, c * half)) for c in p)
                    away = tuple(c * half - k for c, k in zip(p, core))
                    mesh.vertices.append(place(add(core, scaled(unit(away), rounding))))
            for j in range(n):
                for i in range(n):
                    a = first + j * (n + 1) + i
                    quad = (a, a + 1, a + n + 2, a + n + 1) if side > 0 else (a, a + n + 1, a + n + 2, a + 1)
                    mesh.triangles += [(quad[0], quad[1], quad[2]), (quad[0], quad[2], quad[3])]
    return mesh.welded()


def turn_and_move(yaw, pitch, roll, at):
    def place(p):
        x, y, z = p
        y, z = y * math.cos(pitch) - z * math.sin(pitch), y * math.sin(pitch) + z * math.cos(pitch)
        x, y = x * math.cos(roll) - y * math.sin(roll), x * math.sin(roll) + y * math.cos(roll)
        x, z = x * math.cos(yaw) + z * math.sin(yaw), -x * math.sin(yaw) + z * math.cos(yaw)
        return add((x, y, z), at)
    return place


# ---- the bodies ----

def wall(h):
    """The radius of the glass inside, between its floor and its rim."""
    return 35.2 + (38.4 - 35.2) * (h - 12) / (88 - 12)


CONTACT = LEVEL + CLIMB


def glass_outline():
    """From the axis under the glass, over the outside, the rim and the inside, to the axis again; and at which point the
    drink begins. """
    corners = [(0, 2.5, 0), (24, 1.5, 6), (29, 0, 1.5), (37.5, 0, 3.5), (41, 88, 1.25), (wall(88), 88, 1.25),
               (wall(CONTACT), CONTACT, 0), (wall(12), 12, 9), (0, 12, 0)]
    points = rounded(corners)
    contact = min(range(len(points)), key=lambda i: math.hypot(points[i][0] - wall(CONTACT), points[i][1] - CONTACT))
    return points, contact


def surface_outline():
    """The drink's surface from the wall to where it is flat."""
    edge = wall(CONTACT)
    climb = [(edge - d, LEVEL + CLIMB * math.exp(-d / 1.3)) for d in (0.03 * i * i for i in range(15))]
    return climb + [(FLAT, LEVEL)]


def drink_hull():
    glass, contact = glass_outline()
    inside = glass[:contact - 1:-1]  # from the axis up the wall
    pushed = [(0, inside[0][1] - OVERLAP)]
    for i in range(1, len(inside)):
        (ar, ay), (br, by) = inside[i - 1], inside[min(i + 1, len(inside) - 1)]
        length = math.hypot(br - ar, by - ay)
        pushed.append((inside[i][0] + (by - ay) / length * OVERLAP, inside[i][1] - (br - ar) / length * OVERLAP))
    return turned(pushed + surface_outline() + [(0, LEVEL)])


def ice():
    places = [turn_and_move(0.35, 0.12, 0.2, (-12.5, LEVEL + 1.0, 2.0)), turn_and_move(1.1, -0.25, 0.1, (13.0, LEVEL + 0.5, -4.0))]
    return [ice_cube(9, 2.5, 10, place) for place in places]


def bubbles():
    generator, made = random.Random(4), []
    while len(made) < 20:
        a, d, y, radius = (generator.uniform(0, 2 * math.pi), 30 * math.sqrt(generator.random()), generator.uniform(16, 36),
                           generator.uniform(0.4, 1.6))
        centre = (d * math.cos(a), y, d * math.sin(a))
        # not in the rounding of the floor, and apart from each other
        if y - radius < 13 or d + radius > 25 + min(9, y - 12):
            continue
        if all(math.dist(centre, c) > radius + r + 0.5 for c, r in made):
            made.append((centre, radius))
    return [ball(c, r) for c, r in made]


def table():
    h = TABLE_HALF
    return Mesh([(-h, TABLE_Y, h), (h, TABLE_Y, h), (h, TABLE_Y, -h), (-h, TABLE_Y, -h)], [(0, 1, 2), (0, 2, 3)])


def lamp():
    """The lamp's front. Its edges are level, or in the plane that holds the vertical."""
    forward = unit(sub(LAMP["to"], LAMP["from"]))
    side = scaled(unit(cross(forward, (0, 1, 0))), LAMP["size"] / 2)
    up = scaled(unit(cross(side, forward)), LAMP["size"] / 2)
    corners = [add(LAMP["from"], add(scaled(side, a), scaled(up, b))) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    return Mesh(corners, [(0, 2, 1), (0, 3, 2)])


def hulls():
    """(name, medium, mesh) of closed bodies."""
    made = [("tumbler", "glass", turned(glass_outline()[0])), ("filling", "drink", drink_hull())]
    made += [(f"ice{i + 1}", "ice", mesh) for i, mesh in enumerate(ice())]
    many = Mesh()
    for mesh in bubbles():
        many.join(mesh)
    return made + [("bubbles", "air", many)]


# ---- the same, cut ----

def cut(mesh, level):
    """A convex mesh cut by the plane y = level: what is below, what is above, and the loop that they share, in order."""
    parts, loop = (Mesh(), Mesh()), {}
    for triangle in mesh.triangles:
        corners = [mesh.vertices[i] for i in triangle]
        for side, part in ((1, parts[0]), (-1, parts[1])):
            polygon = []
            for i in range(3):
                a, b = corners[i], corners[(i + 1) % 3]
                da, db = side * (level - a[1]), side * (level - b[1])
                if da >= 0:
                    polygon.append(a)
                if (da > 0 > db) or (da < 0 < db):
                    low, high = sorted((a, b))  # the same point from both sides of an edge
                    t = (level - low[1]) / (high[1] - low[1])
                    p = (low[0] + t * (high[0] - low[0]), level, low[2] + t * (high[2] - low[2]))
                    polygon.append(p)
                    loop[tuple(round(c, 6) for c in p)] = True
            n = len(part.vertices)
            part.vertices += polygon
            part.triangles += [(n, n + i, n + i + 1) for i in range(1, len(polygon) - 1)]
    points = list(loop)
    cx, cz = sum(p[0] for p in points) / len(points), sum(p[2] for p in points) / len(points)
    points.sort(key=lambda p: math.atan2(p[2] - cz, p[0] - cx))
    return parts[0].welded(), parts[1].welded(), points


def flat_with_holes(outer, holes, level):
    """Triangles, facing up, between a loop and loops inside of it: the holes are joined to it by bridges, then ears are
    cut off. Points (x, z); seen from above with z down, loops run by angle."""
    def area(a, b, c): return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])

    def crosses(a, b, c, d):
        return area(a, b, c) * area(a, b, d) < 0 and area(c, d, a) * area(c, d, b) < 0

    polygon = list(outer)
    for k, hole in enumerate(holes):
        edges = [(loop[i - 1], loop[i]) for loop in [polygon] + holes[k:] for i in range(len(loop))]
        best = None
        for i, a in enumerate(polygon):
            for j, b in enumerate(hole):
                d = math.dist(a, b)
                if (best is None or d < best[0]) and not any(crosses(a, b, c, e) for c, e in edges):
                    best = (d, i, j)
        _, i, j = best
        polygon = polygon[:i + 1] + hole[j::-1] + hole[:j:-1] + [hole[j]] + polygon[i:]
    triangles = []
    while len(polygon) > 3:
        for i in range(len(polygon)):
            a, b, c = polygon[i - 1], polygon[i], polygon[(i + 1) % len(polygon)]
            if area(a, b, c) <= 1e-12:
                continue
            if any(p not in (a, b, c) and area(a, b, p) >= 0 and area(b, c, p) >= 0 and area(c, a, p) >= 0 for p in polygon):
                continue
            triangles.append((a, b, c))
            del polygon[i]
            break
        else:
            raise SystemExit("glass.py: the drink's surface cannot be cut into triangles")
    triangles.append(tuple(polygon))
    mesh = Mesh()
    for a, b, c in triangles:
        n = len(mesh.vertices)
        mesh.vertices += [(p[0], level, p[1]) for p in (a, c, b)]
        mesh.triangles.append((n, n + 1, n + 2))
    return mesh.welded()


def borders():
    """(name, medium behind, medium in front, mesh) of all borders between two media; normals point to the front."""
    glass, contact = glass_outline()
    cubes = [cut(mesh, LEVEL) for mesh in ice()]
    ring = [(FLAT * math.cos(2 * math.pi * k / AROUND), FLAT * math.sin(2 * math.pi * k / AROUND)) for k in range(AROUND)]
    top = turned(surface_outline())
    top.join(flat_with_holes(ring, [[(p[0], p[2]) for p in loop] for _, _, loop in cubes], LEVEL))
    made = [("glass_air", "glass", "air", turned(glass[:contact + 1])), ("glass_drink", "glass", "drink", turned(glass[contact:])),
            ("drink_air", "drink", "air", top.welded())]
    for i, (below, above, _) in enumerate(cubes):
        made += [(f"ice{i + 1}_drink", "ice", "drink", below), (f"ice{i + 1}_air", "ice", "air", above)]
    return made + [("bubbles", "air", "drink", hulls()[-1][2])]


# ---- for meniscus ----

def write_ply(path, mesh):
    with open(path, "w") as file:
        file.write(f"ply\nformat ascii 1.0\nelement vertex {len(mesh.vertices)}\nproperty float x\nproperty float y\n"
                   f"property float z\nelement face {len(mesh.triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
        file.writelines("%.7g %.7g %.7g\n" % v for v in mesh.vertices)
        file.writelines("3 %d %d %d\n" % t for t in mesh.triangles)


def listed(v): return ", ".join("%.9g" % c for c in v)


def write_scene(folder):
    os.makedirs(folder, exist_ok=True)
    text = "meniscus 1.0 unit mm\n\n// Written by tests/peers/glass.py.\n\n"
    states = {"glass": "solid", "ice": "solid", "drink": "liquid", "air": "gas"}
    for name, (ior, absorption) in MEDIA.items():
        text += f"medium {name} {{ ior = {ior}  absorption = <{listed(absorption)}>  state = {states[name]} }}\n"
    for name, medium, mesh in hulls():
        write_ply(os.path.join(folder, name + ".ply"), mesh)
        text += f'mesh {name} {{ file = "{name}.ply"  interior = {medium} }}\n'
    write_ply(os.path.join(folder, "table.ply"), table())
    text += f'mesh table {{ file = "table.ply"  surface = surface {{ albedo = rgb({listed(TABLE_ALBEDO)}) }} }}\n'
    text += (f'light lamp {{ shape = quad  from = <{listed(LAMP["from"])}>  to = <{listed(LAMP["to"])}>  '
             f'size = <{LAMP["size"]}, {LAMP["size"]}>  radiance = {LAMP["radiance"]} }}\n')
    text += f"environment {{ color = rgb({listed(SKY)}) }}\n"
    text += f'camera {{ from = <{listed(CAMERA["from"])}>  to = <{listed(CAMERA["to"])}>  fov = {CAMERA["fov"]} }}\n'
    text += f"film {{ size = <{SIZE}, {SIZE}>  filter = box  output = [\"glass.exr\", \"glass.png\"] }}\n"
    text += f"render {{ samples = 64  bounces = {BOUNCES} }}\n"
    with open(os.path.join(folder, "glass.mns"), "w") as file:
        file.write(text)


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    write_scene(sys.argv[1])


if __name__ == "__main__":
    main()
