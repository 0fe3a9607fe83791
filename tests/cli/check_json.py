#!/usr/bin/env python3
"""What `check --json` says of broken scenes is what `check` prints: the same reports with the same places, hints, notes
and chains, in the same order.

usage: check_json.py MENISCUS SCENE...
SPDX-License-Identifier: Apache-2.0
"""
import json
import re
import subprocess
import sys

HEAD = re.compile(r"^(?:(?P<file>[^\n]*?):(?P<line>\d+):(?P<column>\d+)|meniscus): (?P<severity>error|warning|remark): "
                  r"(?P<message>.*) \[(?P<code>[a-z0-9-]+)\]$")
NOTE = re.compile(r"^(?P<file>.*?):(?P<line>\d+):(?P<column>\d+): note: (?P<message>.*)$")


def place(item):
    return (item["file"], item["line"], item["column"]) if "file" in item else None


def from_json(document):
    """severity, code, place, message, hint, [notes]; a note at the place of its report is printed without one"""
    reports = []
    for item in document["diagnostics"]:
        notes = [note["message"] for note in item.get("notes", [])]
        reports.append((item["severity"], item["code"], place(item), item["message"], item.get("hint"), notes))
        assert item["severity"] in ("error", "warning", "remark")
        if "file" in item:
            assert item["begin"] <= item["end"] and (item["line"], item["column"]) <= (item["end_line"], item["end_column"])
    return reports


def from_text(text):
    reports = []
    for line in text.splitlines():
        match = HEAD.match(line)
        if match:
            where = (match["file"], int(match["line"]), int(match["column"])) if match["file"] else None
            reports.append([match["severity"], match["code"], where, match["message"], None, []])
        elif reports and line.startswith("      = hint: "):
            reports[-1][4] = line[14:]
        elif reports and line.startswith("      = note: "):
            reports[-1][5].append(line[14:])
        elif reports and NOTE.match(line):
            reports[-1][5].append(NOTE.match(line)["message"])
    return [tuple(report) for report in reports]


def has_own_limit(scene):
    """Whether it comes to a limit that its test lowers, and the command line does not."""
    with open(scene, "rb") as file:
        return re.search(rb"^// option: (calls|file_bytes|files|memory|nodes|steps) ", file.read(), re.M) is not None


def main():
    wrong = n = 0
    scenes = [scene for scene in sys.argv[2:] if not has_own_limit(scene)]
    for scene in scenes:
        run = lambda *options: subprocess.run([sys.argv[1], "check", *options, scene], capture_output=True, timeout=120)
        as_text, as_json = run(), run("--json")
        printed = from_text(as_text.stderr.decode())
        said = from_json(json.loads(as_json.stdout))
        n += len(said)
        if printed != said or as_text.returncode != as_json.returncode:
            wrong += 1
            print(f"{scene}: printed\n  {printed}\nbut --json says\n  {said}")
    print(f"{n} reports of {len(scenes)} scenes agree" if not wrong else f"{wrong} scenes differ")
    return wrong > 0 or n < 100


if __name__ == "__main__":
    sys.exit(main())
