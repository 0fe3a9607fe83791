"""For tests: the pixels of a PNG file of 8 bits, as lists of rows of tuples.

SPDX-License-Identifier: Apache-2.0"""
import struct
import zlib


def pixels(name):
    data, at, packed = open(name, "rb").read(), 8, b""
    while at < len(data):
        n, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + n]
        if kind == b"IHDR":
            width, height, bits, color = struct.unpack(">IIBB", body[:10])
        packed += body if kind == b"IDAT" else b""
        at += n + 12
    assert bits == 8 and color in (2, 6)
    size = 4 if color == 6 else 3
    raw, before, rows = zlib.decompress(packed), [0] * (width * size), []
    for y in range(height):
        line = list(raw[y * (width * size + 1):(y + 1) * (width * size + 1)])
        kind, line = line[0], line[1:]
        for i in range(len(line)):
            a, b = (line[i - size] if i >= size else 0), before[i]
            c = before[i - size] if i >= size else 0
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            line[i] = (line[i] + [0, a, b, (a + b) // 2, paeth][kind]) & 255
        before = line
        rows.append([tuple(line[size * x:size * x + size]) for x in range(width)])
    return rows
