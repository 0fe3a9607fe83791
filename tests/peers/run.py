#!/usr/bin/env python3
"""Compares meniscus with Cycles and POV-Ray on the glass of glass.py, and prints a table.

usage: run.py MENISCUS FOLDER [SECONDS [REFERENCE]]

Needs Debian's packages blender and povray; what is not there is left out. One thread each, 240 x 240, 64 bounces, no
clamping, a box filter; all times are of the processor. meniscus is measured twice: as plain as Cycles, without photons,
with as many samples in all pixels, and single bright ones kept where they fall; and in full, with photons that say where
to look for light behind glass, with samples where they are needed, and single bright ones spread over what is around
them, which loses no light. Paths per second: from renders with few and with more samples, by the difference, so that
start and building do not count; meniscus and Cycles take turns. Error: after SECONDS (16) of rendering, the mean squared
error in ratio to the reference (`meniscus compare`), against each renderer's own picture with REFERENCE (1024) samples a
pixel: meniscus renders by wavelengths and Cycles by three colours, and in deep colours these differ by right. That they
render the same scene is shown by a grey variant, in which they must agree. The pictures stay in FOLDER.
SPDX-License-Identifier: Apache-2.0
"""
import json
import os
import re
import shutil
import subprocess
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
PIXELS, TURNS, FEW, MORE = 240 * 240, 5, 4, 20


def run(command, **more):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}: status {done.returncode}\n{done.stdout[-2000:]}")
    return done.stdout


def median(values):
    return sorted(values)[len(values) // 2]


def spread(values, form):
    return f"{form % median(values)} ({form % min(values)} .. {form % max(values)})"


class Meniscus:
    def __init__(self, program, folder, name, *options):
        self.program, self.folder, self.name, self.options = program, folder, name, options

    def render(self, picture, samples, seed=1, grey=False):
        """Renders and returns seconds of the processor."""
        scene, stats = os.path.join(self.folder, "grey" if grey else "colour", "glass.mns"), os.path.join(self.folder, "stats.json")
        run([self.program, "render", scene, "-q", "-j1", *self.options, "-s", str(samples), "--seed", str(seed),
             f"--stats={stats}", "-o", os.path.join(self.folder, picture)])
        with open(stats) as file:
            return json.load(file)["cpuSeconds"]


class Cycles:
    name = "Cycles"

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.version = ""

    def render(self, picture, samples, seed=1, grey=False):
        environment = dict(os.environ, PEERS_GREY="1" if grey else "")
        said = run([self.program, "-b", "--factory-startup", "--python-exit-code", "1", "--python", os.path.join(HERE, "blender.py"), "--",
                    os.path.join(self.folder, picture), str(samples), str(seed)], env=environment)
        found = re.search(r"peer: cycles (\S+) cpu ([\d.]+)", said)
        if not found:
            raise SystemExit("Cycles did not say how long it took:\n" + said[-2000:])
        self.version = found[1]
        return float(found[2])


def compare(program, folder, a, b):
    said = run([program, "compare", os.path.join(folder, a), os.path.join(folder, b)])
    number = lambda key: [float(x) for x in re.search(key + r"\s+(.*)", said)[1].split()]
    return {"relative": number("relative mse")[0], "rmse": number("rmse")[0], "a": number("mean of A"), "b": number("mean of B")}


def paths_per_second(renderers):
    """Millions, of each in turn, by what more samples cost."""
    rates = {r.name: [] for r in renderers}
    for turn in range(TURNS):
        for r in renderers:
            less, more = (r.render("turn.exr", n, turn + 1) for n in (FEW, MORE))
            rates[r.name].append((MORE - FEW) * PIXELS / (more - less) * 1e-6)
    return rates


def errors(renderers, rates, seconds, reference, program, folder):
    """Samples taken, and errors as they would be after just these seconds: they fall with time."""
    found = {}
    for r in renderers:
        of = f"{r.name.split()[0]}-reference.exr"
        if not r.name.startswith("meniscus "):
            r.render(of, reference, 100)
        samples = max(1, round(seconds * median(rates[r.name]) * 1e6 / PIXELS))
        values = []
        for seed in (1, 2, 3):
            taken = r.render("turn.exr", samples, seed)
            values.append(compare(program, folder, "turn.exr", of)["relative"] * taken / seconds)
        os.replace(os.path.join(folder, "turn.exr"), os.path.join(folder, f"{r.name}.exr"))
        found[r.name] = (samples, values)
    return found


def grey_agreement(renderers, program, folder):
    for r in renderers:
        r.render(f"{r.name}-grey.exr", 256, 7, grey=True)
    return compare(program, folder, *(f"{r.name}-grey.exr" for r in renderers))


def pov(program, folder):
    run([sys.executable, os.path.join(HERE, "pov.py"), os.path.join(folder, "glass.pov")])
    started = os.times()
    run([program, "+Iglass.pov", "+OPOV-Ray.exr", "+FE", "-D", "-V", "-GA", "+W240", "+H240", "+A0.2", "+AM2", "+R2", "+WT1"], cwd=folder)
    ended = os.times()
    return ended.children_user + ended.children_system - started.children_user - started.children_system


def main():
    if not 3 <= len(sys.argv) <= 5:
        raise SystemExit(__doc__)
    program, folder = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    seconds, reference = float(sys.argv[3]) if len(sys.argv) > 3 else 16, int(sys.argv[4]) if len(sys.argv) > 4 else 1024
    for name in ("colour", "grey"):
        run([sys.executable, os.path.join(HERE, "glass.py"), os.path.join(folder, name)],
            env=dict(os.environ, PEERS_GREY="1" if name == "grey" else ""))
    plain = Meniscus(program, folder, "meniscus", "--caustics", "off", "--fireflies", "keep")
    renderers = [plain, Meniscus(program, folder, "meniscus in full", "--caustics", "on", "--adaptive", "on")]
    blender, povray = shutil.which("blender"), shutil.which("povray")
    if blender:
        renderers.append(Cycles(blender, folder))
    else:
        print("no blender here: Cycles is left out")
    start = time.time()
    rates = paths_per_second(renderers)
    print(f"{'':16} {'million paths a second':34} {'samples in %g s' % seconds:>16}  relative mean squared error", flush=True)
    found = errors(renderers, rates, seconds, reference, program, folder)
    for r in renderers:
        samples, values = found[r.name]
        print(f"{r.name:16} {spread(rates[r.name], '%.3f'):34} {samples:16}  {spread(values, '%.5f')}")
    if blender:
        plainly, ours, theirs = (median(found[r.name][1]) for r in renderers)
        print(f"speed, over Cycles {renderers[-1].version}: {median(rates['meniscus']) / median(rates['Cycles']):.2f} x; "
              f"error at equal time, over its: {plainly / theirs:.2f} x, in full {ours / theirs:.2f} x")
        grey = grey_agreement((plain, renderers[-1]), program, folder)
        print(f"in grey both make one picture: means {grey['a'][1]:.4f} and {grey['b'][1]:.4f}, "
              f"relative mean squared difference {grey['relative']:.4f} at 256 samples")
    if povray:
        taken = pov(povray, folder)
        difference = compare(program, folder, "POV-Ray.exr", "meniscus-reference.exr")
        print(f"POV-Ray    no paths: photons and radiosity, 12 levels, antialiasing to 0.2, in {taken:.0f} s; "
              f"its picture differs from ours by {difference['relative']:.3f}")
    print(f"all of it took {time.time() - start:.0f} s")


if __name__ == "__main__":
    main()
