"""Makes the mesh files that tests/cli/import.sh imports, in the current folder.
usage: python3 make_models.py
SPDX-License-Identifier: Apache-2.0"""
import json, math, struct, zlib


def png(width, height, pixel, alpha=False):
    """A picture whose pixels are pixel(x, y): red, green, blue, and alpha where it has one."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    header = struct.pack(">IIBBBBB", width, height, 8, 6 if alpha else 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def lathe(profile, n=48):
    """Points (r, y) from axis to axis, counter-clockwise, turned about y: positions, texture coordinates, triangles."""
    rings = [[(r * math.cos(2 * math.pi * i / n), y, -r * math.sin(2 * math.pi * i / n)) for i in range(n)]
             if r > 0 else [(0, y, 0)] for r, y in profile]
    positions, uvs, first = [], [], []
    for k, ring in enumerate(rings):
        first.append(len(positions))
        positions += ring
        uvs += [(i / n, 1 - k / (len(rings) - 1)) for i in range(len(ring))]
    triangles = []
    for k in range(len(rings) - 1):
        for i in range(n):
            a, b = [first[k] + j % len(rings[k]) for j in (i, i + 1)]
            c, d = [first[k + 1] + j % len(rings[k + 1]) for j in (i, i + 1)]
            triangles += [t for t in ((a, b, d), (a, d, c)) if len(set(t)) == 3]
    return positions, uvs, triangles


def ball(radius, centre=(0, 0, 0), n=32):
    profile = [(radius * math.cos(a), radius * math.sin(a)) for a in (math.pi * (k / n - .5) for k in range(n + 1))]
    profile[0], profile[-1] = (0, -radius), (0, radius)
    positions, uvs, triangles = lathe(profile, 2 * n)
    return [tuple(p[i] + centre[i] for i in range(3)) for p in positions], uvs, triangles


def box(x, y, z, at=(0, 0, 0)):
    corners = [(at[0] + (i & 1) * x, at[1] + (i >> 1 & 1) * y, at[2] + (i >> 2) * z) for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return corners, [(c[0], c[2]) for c in corners], [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


class Glb:
    """A glTF file in the making."""

    def __init__(self):
        self.binary = b""
        self.root = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
                     "materials": [], "accessors": [], "bufferViews": [], "buffers": [{}], "cameras": [],
                     "images": [], "textures": []}

    def view(self, data):
        self.binary += b"\0" * (-len(self.binary) % 4)
        self.root["bufferViews"].append({"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(data)})
        self.binary += data
        return len(self.root["bufferViews"]) - 1

    def accessor(self, rows, kind, code, letter):
        data = b"".join(struct.pack("<%d%s" % (len(row), letter), *row) for row in rows)
        self.root["accessors"].append({"bufferView": self.view(data), "componentType": code, "count": len(rows),
                                       "type": kind})
        return len(self.root["accessors"]) - 1

    def primitive(self, shape, material=None):
        positions, uvs, triangles = shape
        made = {"attributes": {"POSITION": self.accessor(positions, "VEC3", 5126, "f"),
                               "TEXCOORD_0": self.accessor(uvs, "VEC2", 5126, "f")},
                "indices": self.accessor([(i,) for t in triangles for i in t], "SCALAR", 5125, "I")}
        return made if material is None else dict(made, material=material)

    def mesh(self, *primitives):
        self.root["meshes"].append({"name": "Mesh", "primitives": list(primitives)})
        return len(self.root["meshes"]) - 1

    def node(self, name=None, parent=None, **members):
        self.root["nodes"].append(dict(members, **({"name": name} if name is not None else {})))
        number = len(self.root["nodes"]) - 1
        if parent is None:
            self.root["scenes"][0]["nodes"].append(number)
        else:
            self.root["nodes"][parent].setdefault("children", []).append(number)
        return number

    def material(self, name, color=(1, 1, 1, 1), metal=0, rough=0, extensions=None, **members):
        look = {"baseColorFactor": list(color), "metallicFactor": metal, "roughnessFactor": rough}
        look.update(members.pop("look", {}))
        material = dict({"name": name, "pbrMetallicRoughness": look}, **members)
        if extensions:
            material["extensions"] = {"KHR_materials_" + k: v for k, v in extensions.items()}
        self.root["materials"].append(material)
        return len(self.root["materials"]) - 1

    def texture(self, name, data):
        self.root["images"].append({"name": name, "mimeType": "image/png", "bufferView": self.view(data)})
        self.root["textures"].append({"source": len(self.root["images"]) - 1})
        return {"index": len(self.root["textures"]) - 1}

    def write(self, path):
        self.root["buffers"][0]["byteLength"] = len(self.binary)
        root = {k: v for k, v in self.root.items() if v not in ([], {})}
        text = json.dumps(root).encode()
        text += b" " * (-len(text) % 4)
        data = self.binary + b"\0" * (-len(self.binary) % 4)
        with open(path, "wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 12 + 16 + len(text) + len(data)))
            file.write(struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data)


CLEAR = {"transmission": {"transmissionFactor": 1}, "ior": {"ior": 1.5}}
TUMBLER = [(0, 0), (.035, 0), (.038, .09), (.0355, .09), (.0325, .008), (0, .008)]
WHISKY = [(0, .0078), (.0327, .0078), (.0343, .05), (0, .05)]
LABEL = png(64, 64, lambda x, y: (200, 60, 40) if (x // 8 + y // 8) % 2 else (240, 230, 200))


def drink():
    """A tumbler with a drink: glass, liquid, a ball of metal, a table with a picture, a camera and a lamp."""
    g = Glb()
    glass = g.material("Glass", extensions=CLEAR)
    whisky = g.material("Whisky", extensions={
        "transmission": {"transmissionFactor": 1}, "ior": {"ior": 1.36},
        "volume": {"thicknessFactor": .05, "attenuationDistance": .012, "attenuationColor": [.85, .42, .08]}})
    gold = g.material("Gold", (1, .77, .34, 1), 1, .2)
    oak = g.material("Oak", rough=.5, look={"baseColorTexture": g.texture("Oak Planks", LABEL)})
    g.node("Tumbler", mesh=g.mesh(g.primitive(lathe(TUMBLER), glass)))
    g.node("Drink", mesh=g.mesh(g.primitive(lathe(WHISKY), whisky)))
    g.node("Ball", mesh=g.mesh(g.primitive(ball(.02), gold)), translation=[.07, .02, .02])
    g.node("Table", mesh=g.mesh(g.primitive(box(.6, .02, .6, (-.3, -.0201, -.3)), oak)))
    g.root["cameras"] = [{"type": "perspective", "perspective": {"yfov": .4, "aspectRatio": 1.5}}]
    turn = math.radians(-18) / 2
    g.node("Camera", camera=0, translation=[0, .17, .38], rotation=[math.sin(turn), 0, 0, math.cos(turn)])
    g.root["extensions"] = {"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1, .9, .8], "intensity": 10 * 683 / (4 * math.pi)},
        {"type": "spot", "intensity": 400, "spot": {"innerConeAngle": .2, "outerConeAngle": .4}},
        {"type": "directional", "intensity": 683}]}}
    for i, name in enumerate(["Lamp", "Spot", "Sun"]):
        g.node(name, translation=[-.3, .5, .3], rotation=[-.38, 0, 0, .92],
               extensions={"KHR_lights_punctual": {"light": i}})
    g.write("drink.glb")


def clear():
    """Glass and a lamp, and nothing that the lamp lights."""
    g = Glb()
    g.node("Tumbler", mesh=g.mesh(g.primitive(lathe(TUMBLER), g.material("Glass", extensions=CLEAR))))
    g.root["extensions"] = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 54351}]}}
    g.node("Light", translation=[.4, .6, .3], extensions={"KHR_lights_punctual": {"light": 0}})
    g.write("clear.glb")


def odd():
    """Names that are none, and twice, and words of the language; a child within its parent; two materials in one mesh."""
    g = Glb()
    first = g.material("Glass", extensions=dict(CLEAR, dispersion={"dispersion": .4}))
    second = g.material("Glass", (.2, .8, .4, 1), extensions=CLEAR, rough=.3)
    red = g.material("sphere", (.8, .05, .05, 1), rough=.4, extensions={"clearcoat": {"clearcoatFactor": 1}})
    unnamed = g.material("", (.1, .2, .8, 1), rough=1, extensions={"sheen": {"sheenColorFactor": [.5, .5, .6],
                                                                            "sheenRoughnessFactor": .3}})
    quoted = g.material('"; } // \\ \u00e9\n*/', (.5, .5, .5, .4), alphaMode="BLEND")
    parent = g.node("Glass", mesh=g.mesh(g.primitive(ball(.5), first)))
    g.node("Glass", parent, mesh=g.mesh(g.primitive(ball(.4), second)), translation=[1.2, 0, 0])
    g.node("3D-Torus/\u00e4", mesh=g.mesh(g.primitive(ball(.3), red), g.primitive(ball(.2, (0, .6, 0)), unnamed)),
           translation=[-1, 0, 0])
    g.node(None, mesh=g.mesh(g.primitive(box(.4, .4, .4), quoted)), translation=[0, .6, .3])
    g.node("", mesh=g.mesh(g.primitive(box(.2, .2, .2))), translation=[.8, .6, .3])
    g.node("camera", mesh=g.mesh(g.primitive(ball(.2), first)), translation=[.4, -.4, .8])
    g.write("odd.glb")


def kinds():
    """One of everything that a material can say."""
    g = Glb()
    grid = png(16, 16, lambda x, y: (255, 16 * y, 16 * x))
    holes = png(32, 32, lambda x, y: (40, 160, 60, 255 if (x - 16) ** 2 + (y - 16) ** 2 < 180 else 0), True)
    normal = png(16, 16, lambda x, y: (128 + 40 * (x % 4 - 1), 128, 240))
    moved = {"KHR_texture_transform": {"offset": [.1, .2], "scale": [2, 3], "rotation": .5}}
    leaf = dict(g.texture("../evil/leaf", holes))
    rows = [
        ("Bubble Film", dict(extensions={"transmission": {"transmissionFactor": 1}, "ior": {"ior": 1.33},
                                         "volume": {"thicknessFactor": 0},
                                         "iridescence": {"iridescenceFactor": 1, "iridescenceThicknessMaximum": 500}})),
        ("Frosted", dict(color=(.6, .8, .9, 1), rough=.35, extensions=CLEAR)),
        ("Painted", dict(color=(.9, .2, .1, 1), extensions={"transmission": {"transmissionFactor": .5}})),
        ("Leaf", dict(alphaMode="MASK", alphaCutoff=.4, rough=.6, look={"baseColorTexture": leaf})),
        ("Veil", dict(alphaMode="BLEND", rough=.6, look={"baseColorTexture": leaf})),
        ("Rough", dict(metal=1, rough=1, look={"metallicRoughnessTexture": dict(g.texture("ORM", grid),
                                                                                extensions=moved)},
                       normalTexture=dict(g.texture("ORM", normal), scale=.5))),
        ("Lamp", dict(emissiveFactor=[1, .5, .1], extensions={"emissive_strength": {"emissiveStrength": 5}})),
        ("Screen", dict(extensions={"unlit": {}}, color=(.2, .4, .6, 1))),
        ("Paper", dict(rough=.9, extensions={"diffuse_transmission": {"diffuseTransmissionFactor": .4}})),
        ("Clay", dict(color=(.6, .3, .2, 1), extensions={"specular": {"specularFactor": 0}})),
        ("Dull", dict(color=(.5, .4, .3, 1), rough=1, look={"baseColorTexture": {"index": 99}})),
        ("Brushed", dict(color=(.9, .9, .9, 1), metal=1, rough=.3, extensions={
            "anisotropy": {"anisotropyStrength": .7}, "iridescence": {"iridescenceFactor": .5}})),
        ("Water", dict(extensions={"transmission": {"transmissionFactor": 1}, "ior": {"ior": 1.333}, "volume": {
            "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [.7, .9, .95]}})),
    ]
    for i, (name, members) in enumerate(rows):
        g.node(name, mesh=g.mesh(g.primitive(ball(.4), g.material(name, **members))), translation=[i % 5, 0, i // 5])
    open_box = box(.4, .4, .4)
    g.node("Open", mesh=g.mesh(g.primitive((open_box[0], open_box[1], open_box[2][2:]), 1)), translation=[4, -.2, 2])
    g.write("kinds.glb")


def obj():
    """Wavefront: two objects, glass as two programs write it, a metal, a picture that is there and one that is not."""
    lines, n = ["mtllib parts.mtl"], 1
    for name, material, shape in (("Bottle", "green glass", ball(.05)), ("Cap", "steel", box(.02, .02, .02, (0, .06, 0))),
                                  ("Label", "paper", box(.02, .02, .02, (.06, .06, 0))), ("Rest", None, ball(.01))):
        lines += ["o " + name] + (["usemtl " + material] if material else [])
        lines += ["v %.6f %.6f %.6f" % p for p in shape[0]]
        lines += ["f " + " ".join(str(i + n) for i in t) for t in shape[2]]
        n += len(shape[0])
    with open("bottle.obj", "w") as file:
        file.write("\n".join(lines) + "\n")
    with open("parts.mtl", "w") as file:
        file.write("newmtl green glass\nKd .2 .6 .3\nNi 1.52\nd .1\nillum 7\nNs 1000\n"
                   "newmtl steel\nKd .6 .6 .6\nPm 1\nPr .3\nnewmtl paper\nKd .9 .9 .9\nKs 0 0 0\n"
                   "map_Kd maps\\paper.png\nmap_Bump gone.png\n")


def others():
    positions, _, triangles = ball(20)
    with open("ball.stl", "wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", len(triangles)))
        for t in triangles:
            file.write(struct.pack("<12fH", 0, 0, 0, *(c for i in t for c in positions[i]), 0))
    with open("open.ply", "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                   "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")


if __name__ == "__main__":
    for make in (drink, clear, odd, kinds, obj, others):
        make()
