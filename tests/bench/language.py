#!/usr/bin/env python3
"""How fast scenes are read: figures to compare between versions, and with POV-Ray where it is installed.

usage: language.py MENISCUS

'meniscus params' reads and evaluates a scene and builds nothing. Seconds are of the processor, so that other programs
change them little; the time of an empty scene is taken off, and of three runs the fastest counts. POV-Ray's scenes do
the same work, and of what it does only its own figure for parsing counts, the fastest of two runs.
SPDX-License-Identifier: Apache-2.0
"""
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile

N_VERTICES, N_TURNS, N_SPHERES, N_CALLS, N_QUERIES = 400000, 10000000, 1000000, 2000000, 1000000
POV_TURNS, POV_CALLS = 1000000, 100000


def mesh_numbers():
    generator = random.Random(1)
    vertices = [tuple(generator.uniform(-100, 100) for _ in range(3)) for _ in range(N_VERTICES)]
    faces = [(i, i + 1, i + 2) for i in range(N_VERTICES - 2)]
    return ([", ".join(f"{c:.6f}" for c in v) for v in vertices], [", ".join(map(str, f)) for f in faces])


def listed(items):
    return ",\n".join(", ".join(f"<{item}>" for item in items[i:i + 4]) for i in range(0, len(items), 4))


def measure(command, folder, runs=3, said=None):
    """Seconds of the processor and MB of memory; said: an expression for the seconds in what the command prints."""
    best, memory = 1e9, 0
    for _ in range(runs):
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        errors = process.stderr.read().decode()
        _, status, usage = os.wait4(process.pid, 0)
        if status:
            raise SystemExit(f"{' '.join(command)} failed:\n{errors[-2000:]}")
        seconds = float(re.search(said, errors)[1]) if said else usage.ru_utime + usage.ru_stime
        best, memory = min(best, seconds), usage.ru_maxrss / 1000
    return best, memory


class Bench:
    def __init__(self, folder, program):
        self.folder, self.program = folder, program
        self.empty = measure(self.command("empty", ""), folder)[0]
        self.povray = shutil.which("povray")

    def command(self, name, text):
        with open(os.path.join(self.folder, name + ".mns"), "w") as file:
            file.write("meniscus 1.0 unit mm\n" + text)
        return [self.program, "params", name + ".mns"]

    def run(self, name, text):
        seconds, memory = measure(self.command(name, text), self.folder)
        return max(seconds - self.empty, 1e-6), memory

    def pov(self, name, text):
        with open(os.path.join(self.folder, name + ".pov"), "w") as file:
            file.write("#version 3.7;\nglobal_settings { assumed_gamma 1 }\ncamera { location <0,0,-9> look_at 0 }\n" + text)
        command = [self.povray, f"+I{name}.pov", "-D", "-F", "+W1", "+H1", "-A", "Bounding=off"]
        seconds, memory = measure(command, self.folder, 2, r"Parse Time:[^\n]*\n\s*using 1 thread\(s\) with ([\d.]+) CPU-seconds")
        return max(seconds, 1e-6), memory

    def beside(self, text, number, format_of):
        print(f"{text:44}{format_of(number[0])}" + (f"    POV-Ray {format_of(number[1])}" if number[1] else ""))


def bench_numbers(bench):
    vertices, faces = mesh_numbers()
    text = f"let m = mesh {{ positions = [{listed(vertices)}]\ntriangles = [{listed(faces)}]\nsurface = surface {{ }} }}\nm {{ }}\n"
    seconds, _ = bench.run("mesh", text)
    other = 0
    if bench.povray:
        pov = (f"mesh2 {{ vertex_vectors {{ {len(vertices)}, {listed(vertices)} }}\n"
               f"face_indices {{ {len(faces)}, {listed(faces)} }} }}\n")
        other = len(pov) / 1e6 / bench.pov("mesh", pov)[0]
    bench.beside("numbers of an inline mesh", (len(text) / 1e6 / seconds, other), lambda x: f"{x:9.1f} MB/s")


def bench_operations(bench):
    body = "s := (s + i * 2 - 1) % 1000"  # four operations, an assignment, a turn of the loop
    seconds, _ = bench.run("turns", f"var s = 0\nfor (i in 1..{N_TURNS}) {{ {body} }}\nprint(s)\n")
    other = 0
    if bench.povray:
        other = bench.pov("turns", f"#declare S = 0;\n#for (I, 1, {POV_TURNS})\n#declare S = mod(S + I * 2 - 1, 1000);\n#end\n")[0]
    bench.beside("turns of a loop", (N_TURNS / seconds / 1e6, other and POV_TURNS / other / 1e6), lambda x: f"{x:9.2f} million/s")
    bench.beside("simple operations (6 in a turn)", (6 * N_TURNS / seconds / 1e6, other and 6 * POV_TURNS / other / 1e6),
                 lambda x: f"{x:9.2f} million/s")


def bench_objects(bench):
    place = "<rnd(1, i) * 100, rnd(2, i) * 100, rnd(3, i) * 100>"
    text = (f"let grey = surface {{ }}\nfor (i in 1..{N_SPHERES}) {{ sphere {{ center = {place}  radius = .1  surface = grey }} }}\n")
    seconds, memory = bench.run("spheres", text)
    other = (0, 0)
    if bench.povray:
        pov = (f"#declare R = seed(1);\nunion {{\n#for (I, 1, {N_SPHERES})\n"
               "sphere { <rand(R), rand(R), rand(R)> * 100, .1 }\n#end\n}\n")
        other = bench.pov("spheres", pov)
    bench.beside(f"{N_SPHERES} spheres from a loop", (seconds, other[0]), lambda x: f"{x:9.2f} s")
    bench.beside("their memory", (memory * 1e6 / N_SPHERES, other[1] * 1e6 / N_SPHERES), lambda x: f"{x:9.0f} bytes each")


def bench_statements(bench):
    generator = random.Random(2)
    place = lambda: ", ".join(f"{generator.uniform(-100, 100):.4f}" for _ in range(3))
    lines = [f"sphere {{ center = <{place()}>  radius = {generator.uniform(.1, 1):.3f}  interior = m }}\n"
             for _ in range(N_SPHERES)]
    text = "medium m { ior = 1.5 }\n" + "".join(lines)
    seconds, memory = bench.run("flat", text)
    layout, layout_memory = measure([bench.program, "fmt", "--check", "flat.mns"], bench.folder)
    other = (0, 0)
    if bench.povray:
        pov = "".join(f"sphere {{ <{place()}>, {generator.uniform(.1, 1):.3f} interior {{ ior 1.5 }} }}\n" for _ in range(N_SPHERES))
        other = (len(pov) / 1e6 / bench.pov("flat", "union {\n" + pov + "}\n")[0], 0)
    bench.beside(f"text of {N_SPHERES} statements, read", (len(text) / 1e6 / seconds, other[0]), lambda x: f"{x:9.1f} MB/s")
    print(f"{'the same, laid out by fmt':44}{len(text) / 1e6 / layout:9.1f} MB/s")
    print(f"{'memory of both':44}{memory:9.0f} and {layout_memory:.0f} MB")


def bench_geometry(bench):
    """The loop without the question is taken off."""
    def rate(shape, question, n=N_QUERIES):
        before = f"let s = {shape}\nvar n = 0\nfor (i in 1..{n}) {{ let p = <.001, .002, 1e-7 * i>  if ("
        whole, _ = bench.run("asked", f"{before}{question}) {{ n := n + 1 }} }}\nprint(n)\n")
        empty, _ = bench.run("unasked", f"{before}p.x < 1) {{ n := n + 1 }} }}\nprint(n, len([s]))\n")
        return n / max(whole - empty, 1e-6) / 1e6
    ball = "sphere { radius = 2 }"
    cup = "lathe { profile = [<0, 0>, <2, 0>, <2, 5>, <1.8, 5>, <1.8, .2>, <0, .2>]  rounding = [0, .1, .05, .05, .1, 0] }"
    brick = "box { size = <2, 3, 4>  bevel = .2  bevel_segments = 8 }"
    for name, shape in (("a sphere", ball), ("a lathe", cup), ("a mesh of a box with rounds", brick)):
        print(f"{'inside() of ' + name:44}{rate(shape, 'inside(s, p)'):9.2f} million/s")
        print(f"{'hit() of ' + name:44}{rate(shape, 'hit(s, p, y) != none'):9.2f} million/s")
    print(f"{'scatter() on a sphere':44}{rate(ball, 'scatter(s, i) != none'):9.2f} million/s")


def bench_macros(bench):
    macro = "def step(n) { if (n > 5) { print(n) } }\n"
    with open(os.path.join(bench.folder, "parts.mns"), "w") as file:
        file.write("meniscus 1.0\n" + macro)
    calls = f"for (i in 1..{N_CALLS}) {{ step(i % 5) }}\n"
    here, _ = bench.run("here", macro + calls)
    included, _ = bench.run("included", 'include "parts.mns"\n' + calls)
    used, _ = bench.run("used", 'use "parts.mns" as parts\n' + calls.replace("step(", "parts.step("))
    others = [0, 0]
    if bench.povray:
        pov = "#macro Step(N) #if (N > 5) #debug \"x\" #end #end\n"
        with open(os.path.join(bench.folder, "parts.inc"), "w") as file:
            file.write(pov)
        loop = f"#for (I, 1, {POV_CALLS})\nStep(mod(I, 5))\n#end\n"
        others = [POV_CALLS / bench.pov("here", pov + loop)[0] / 1e6,
                  POV_CALLS / bench.pov("included", '#include "parts.inc"\n' + loop)[0] / 1e6]
    rate = lambda x: f"{x:9.2f} million/s"
    bench.beside("calls of a macro of the same file", (N_CALLS / here / 1e6, others[0]), rate)
    bench.beside("calls of a macro from an include", (N_CALLS / included / 1e6, others[1]), rate)
    bench.beside("calls of a macro from a use", (N_CALLS / used / 1e6, 0), rate)


def main():
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder, os.path.abspath(sys.argv[1]))
        print(f"{'start, with an empty scene':44}{bench.empty * 1000:9.1f} ms")
        bench_numbers(bench)
        bench_operations(bench)
        bench_objects(bench)
        bench_statements(bench)
        bench_macros(bench)
        bench_geometry(bench)
        if not bench.povray:
            print("POV-Ray is not installed: nothing to compare with")


if __name__ == "__main__":
    main()
