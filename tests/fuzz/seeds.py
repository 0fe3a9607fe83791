#!/usr/bin/env python3
"""Small right inputs for the fuzzers to begin with, beside the scenes of examples, tests and the library.

usage: seeds.py FOLDER MENISCUS     makes FOLDER/NAME/ for each fuzzer; the states of renders are written by the program
SPDX-License-Identifier: Apache-2.0
"""
import base64
import glob
import json
import os
import shutil
import struct
import subprocess
import sys
import zlib

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
POINTS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]
LARGEST_SCENE = 20000
NOT_FINISHED = 75  # the exit status
SMALL_SCENE = """meniscus 1.0
medium water { ior = 1.33 }
sphere drop { interior = water }
ground { y = -1  surface = surface { albedo = .5 } }
light { from = <3, 5, -3>  to = <0, 0, 0>  size = <.2, .2>  radiance = 400 }
camera { from = <0, 1, -6>  to = <0, 0, 0> }
film { size = <6, 4> }
"""


def put(folder, name, text):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "wb") as file:
        file.write(text if isinstance(text, bytes) else text.encode())


def scenes(folder):
    for pattern in ("examples/*.mns", "tests/lang/*.mns", "tests/diag/*.mns", "tests/diag/scene/*.mns", "src/std/*.mns"):
        for path in glob.glob(os.path.join(ROOT, pattern)):
            if os.path.getsize(path) < LARGEST_SCENE:
                shutil.copy(path, os.path.join(folder, os.path.basename(path)))


def ply(form, order=""):
    head = (f"ply\nformat {form} 1.0\ncomment seed\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "element face 4\nproperty list uchar int vertex_indices\nend_header\n").encode()
    if form == "ascii":
        rows = [" ".join(map(str, p)) for p in POINTS] + ["3 " + " ".join(map(str, f)) for f in FACES]
        return head + ("\n".join(rows) + "\n").encode()
    return (head + b"".join(struct.pack(order + "3f", *p) for p in POINTS) +
            b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES))


def stl():
    body = b"".join(struct.pack("<3f", 0, 0, 1) + b"".join(struct.pack("<3f", *POINTS[i]) for i in f) + b"\0\0" for f in FACES)
    return b"seed".ljust(80) + struct.pack("<I", len(FACES)) + body


def stl_text():
    facet = lambda f: "facet normal 0 0 1\nouter loop\n" + "".join("vertex %g %g %g\n" % POINTS[i] for i in f) + "endloop\nendfacet\n"
    return "solid seed\n" + "".join(map(facet, FACES)) + "endsolid seed\n"


def gemcad():
    return b"GemCad 5.0\r\ng 96 0.0\r\ny 4 y\r\nI 1.76\r\nH seed\r\na -90 1 96 n G1 24 48 72\r\na 45 .92 96\r\n24 48 72 G note\r\na 0 .6\r\na -0 .2 96\r\n"


def gltf():
    data = b"".join(struct.pack("<3f", *p) for p in POINTS) + b"".join(struct.pack("<3H", *f) for f in FACES)
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "cameras": [{"perspective": {"yfov": .5, "aspectRatio": 1.5}}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 100, "color": [1, .5, 0]}]}},
        "nodes": [{"mesh": 0, "camera": 0, "extensions": {"KHR_lights_punctual": {"light": 0}}, "name": "seed", "translation": [1, 2, 3], "scale": [2, 2, 2], "rotation": [0, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}], 
        "materials": [{"name": "glass", "alphaMode": "MASK", "pbrMetallicRoughness": {"baseColorFactor": [.5, .9, .7, 1], "roughnessFactor": .2,
                       "baseColorTexture": {"index": 0}, "metallicFactor": 0}, "extensions": {
                           "KHR_materials_transmission": {"transmissionFactor": .9}, "KHR_materials_ior": {"ior": 1.5},
                           "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": .1, "attenuationColor": [.9, .4, .1]}}}],
        "textures": [{"source": 0}], "images": [{"name": "label", "uri": "data:image/png;base64,iVBORw0KGgo="}],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}]}
    chunk = lambda kind, body, fill: struct.pack("<I", len(body) + -len(body) % 4) + kind + body + fill * (-len(body) % 4)
    packed = chunk(b"JSON", json.dumps(document).encode(), b" ") + chunk(b"BIN\0", data, b"\0")
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    return json.dumps(document), b"glTF" + struct.pack("<II", 2, 12 + len(packed)) + packed


def png(depth, kind):
    chunk = lambda name, body: struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
    size = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[kind] * depth // 8 or 1
    rows = b"".join(b"\0" + bytes((7 * i + 11 * j) % 3 for i in range(4 * size)) for j in range(4))
    palette = chunk(b"PLTE", bytes(range(9))) if kind == 3 else b""
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, depth, kind, 0, 0, 0)) + palette +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def jpeg(components, progressive):
    """8 by 8 pixels of grey. Each table of codes has one, of one bit, which says that there is no more."""
    segment = lambda marker, body: bytes([0xff, marker]) + struct.pack(">H", len(body) + 2) + body
    codes = lambda kind: segment(0xc4, bytes([kind << 4, 1] + 15 * [0] + [0]))
    frame = struct.pack(">BHHB", 8, 8, 8, components) + b"".join(bytes([i, 0x11, 0]) for i in range(components))
    scan = bytes([components]) + b"".join(bytes([i, 0]) for i in range(components)) + bytes([0, 0 if progressive else 63, 0])
    bits = (components * ("0" if progressive else "00")).ljust(8, "1")
    return (b"\xff\xd8" + segment(0xdb, b"\0" + 64 * b"\1") + segment(0xc2 if progressive else 0xc0, frame) + codes(0) + codes(1) +
            segment(0xda, scan) + bytes([int(bits, 2)]) + b"\xff\xd9")


def hdr(kind, order):
    """8 by 8 pixels: flat, or in runs of the old or the new kind."""
    line = {"flat": b"".join(bytes([7 * i, 90, 255 - i, 128]) for i in range(8)),
            "old": bytes([9, 90, 30, 128, 1, 1, 1, 4, 50, 60, 70, 127, 1, 1, 1, 2]),
            "new": b"\2\2\0\x08" + bytes([136, 90, 3, 1, 2, 3, 133, 7, 8] + list(range(8)) + [136, 128])}[kind]
    return (b"#?RADIANCE\n# seed\nFORMAT=32-bit_rle_" + (b"xyze" if kind == "old" else b"rgbe") + b"\nEXPOSURE=2\n" +
            b"COLORCORR=1 .5 2\nPRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n\n" + order.encode() + b"\n" + 8 * line)


def exr(half, compression):
    attribute = lambda name, kind, value: name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    channels = b"".join(c + b"\0" + struct.pack("<iB3xii", 1 if half else 2, 0, 1, 1) for c in (b"B", b"G", b"R")) + b"\0"
    window = struct.pack("<4i", 0, 0, 3, 1)
    header = struct.pack("<II", 20000630, 2) + b"".join([
        attribute("channels", "chlist", channels), attribute("compression", "compression", bytes([compression])),
        attribute("dataWindow", "box2i", window), attribute("displayWindow", "box2i", window),
        attribute("lineOrder", "lineOrder", b"\0"), attribute("pixelAspectRatio", "float", struct.pack("<f", 1)),
        attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)),
        attribute("screenWindowWidth", "float", struct.pack("<f", 1))]) + b"\0"
    row = bytes(range(3 * 4 * (2 if half else 4)))
    first = len(header) + 16
    return (header + struct.pack("<2Q", first, first + 8 + len(row)) +
            b"".join(struct.pack("<ii", j, len(row)) + row for j in range(2)))


def states(folder, program):
    """Of renders by samples, as slices are, and of one that has not come to its end."""
    scene = os.path.join(folder, "small.mns")
    put(folder, "small.mns", SMALL_SCENE)
    runs = {"whole": ["-s", "8", "--sample-range", "1..8"],
            "slice": ["-s", "8", "--sample-range", "3..6", "--aov", "cryptomatte,depth,object", "--crop", "1,1,5,4"],
            "adaptive": ["-s", "1000000", "--adaptive", "on", "--time-limit", "1s", "--checkpoint", "1m"],
            "photons": ["-s", "1000000", "--caustics", "on", "--time-limit", "0.001s", "--checkpoint", "1m"]}
    for name, options in runs.items():
        command = [program, "render", scene, "-q", "-j1", "-o", os.path.join(folder, name + ".exr")]
        if "--caustics" not in options:
            options = options + ["--caustics", "off"]
        if subprocess.run(command + options, check=False).returncode not in (0, NOT_FINISHED):
            sys.exit(f"seeds.py: no state of a render, {name}")
    for name in ("adaptive", "photons"):
        os.replace(os.path.join(folder, name + ".checkpoint.exr"), os.path.join(folder, name + ".exr"))
    os.remove(scene)


def main():
    top = sys.argv[1]
    states(os.path.join(top, "checkpoint"), sys.argv[2])
    for name in ("whole", "slice"):  # pictures, too: compressed, with many channels and attributes
        os.makedirs(os.path.join(top, "exr"), exist_ok=True)
        shutil.copy(os.path.join(top, "checkpoint", name + ".exr"), os.path.join(top, "exr"))
    for name in ("lex_parse", "eval", "fmt"):
        put(os.path.join(top, name), "header.mns", "meniscus 1.0 unit mm\n")
        scenes(os.path.join(top, name))
    for form, order in (("ascii", ""), ("binary_little_endian", "<"), ("binary_big_endian", ">")):
        put(os.path.join(top, "ply"), form + ".ply", ply(form, order))
    lines = ["o seed"] + ["v %g %g %g" % p for p in POINTS] + ["vt 0 0", "vn 0 0 1", "usemtl glass"]
    put(os.path.join(top, "obj"), "seed.obj", "\n".join(lines + ["f %d//1 %d/1/1 %d" % tuple(i + 1 for i in f) for f in FACES]) + "\n")
    put(os.path.join(top, "obj"), "quad.obj", "\n".join(lines + ["f -1 -2 -3 -4", "g a b", "s off"]) + "\n")
    put(os.path.join(top, "gemcad"), "block.asc", gemcad())
    put(os.path.join(top, "stl"), "binary.stl", stl())
    put(os.path.join(top, "stl"), "text.stl", stl_text())
    for path in glob.glob(os.path.join(ROOT, "tests", "unit", "*.nvdb")):
        with open(path, "rb") as file:
            put(os.path.join(top, "nvdb"), os.path.basename(path), file.read())
    text, packed = gltf()
    put(os.path.join(top, "gltf"), "seed.gltf", text)
    put(os.path.join(top, "gltf"), "seed.glb", packed)
    for depth, kind in ((8, 2), (16, 2), (8, 6), (8, 0), (8, 3), (1, 0)):
        put(os.path.join(top, "png"), f"{depth}-{kind}.png", png(depth, kind))
    for components in (1, 3):
        for progressive in (False, True):
            put(os.path.join(top, "jpeg"), f"{components}-{progressive}.jpg", jpeg(components, progressive))
    for kind in ("flat", "old", "new"):
        for order in ("-Y 8 +X 8", "+X 8 +Y 8"):
            put(os.path.join(top, "hdr"), f"{kind}{order[:2]}.hdr", hdr(kind, order))
    for half in (True, False):
        for compression in (0, 1, 3):
            put(os.path.join(top, "exr"), f"{half}-{compression}.exr", exr(half, compression))
    for path in glob.glob(os.path.join(ROOT, "tests", "unit", "*.ies")):
        with open(path, "rb") as file:
            put(os.path.join(top, "profile"), os.path.basename(path), file.read())
    put(os.path.join(top, "spectrum"), "columns.txt", "# nm value\n380 0.1\n500, 0.25\n780\t1e-3\n")
    put(os.path.join(top, "spectrum"), "heading.csv", "wavelength,absorption\n400,1\n700,2\n")
    words = ["scene.mns\n-o\nx.exr\n-s\n64", "--size\n640x480\n--crop\n0,0,1,1\na.mns", "-D\na=1\n--set\ncamera.fov=3\n-j4\nx", "--help", "-"]
    for i, text in enumerate(words):
        for command in range(4):
            put(os.path.join(top, "options"), f"{command}-{i}", bytes([command]) + text.encode())


if __name__ == "__main__":
    main()
