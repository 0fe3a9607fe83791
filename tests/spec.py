#!/usr/bin/env python3
"""Runs the examples of a specification: each fenced block is a scene.

usage: spec.py MENISCUS SPEC.md

Marks at the end of a line: // expect: what its print prints, // error: code and // warning: code for a report in that line.
A block is run again without the lines that were reported, because a mistake in the syntax hides those in the meaning, and
those hide what is printed; each mark must be met in the end, and nothing may be reported without one. Behind the fence
'whole' means that the block has its own header, and it and 'once' that it is run as it stands, only once.
SPDX-License-Identifier: Apache-2.0
"""
import json
import os
import re
import subprocess
import sys
import tempfile

MARK = re.compile(r"\s*// (expect|error|warning): (.*)$")


def blocks(text):
    """(line number, word behind the fence, lines)"""
    found, inside = [], None
    for number, line in enumerate(text.splitlines(), 1):
        if line.startswith("```"):
            if inside is None:
                inside = (number + 1, line[3:].strip(), [])
                continue
            found.append(inside)
            inside = None
        elif inside is not None:
            inside[2].append(line)
    return found


def run(program, lines):
    """The reports as (line, severity, code), and what was printed."""
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "spec.mns"), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
        done = subprocess.run([os.path.abspath(program), "dump", "spec.mns", "--log-format", "json"], cwd=folder,
                              capture_output=True, text=True, encoding="utf-8")
    reports, printed = set(), ""
    for line in done.stderr.splitlines():
        event = json.loads(line)
        if event["event"] == "print":
            printed += event["text"]
        for report in event.get("diagnostics", []):
            reports.add((report["line"], report["severity"], report["code"]))
    return reports, printed


def check(program, start, word, lines):
    whole = word == "whole"
    header = [] if whole else ["meniscus 1.0 unit mm"]
    wanted, expected, text = set(), "", list(header)
    for line in lines:
        mark = MARK.search(line)
        if mark and mark.group(1) == "expect":
            expected += mark.group(2) + "\n"
        elif mark:
            wanted.add((len(text) + 1, mark.group(1), mark.group(2).strip()))
        text.append(MARK.sub("", line) if mark else line)
    problems, seen = [], set()
    for _ in range(20):
        reports, printed = run(program, text)
        for report in sorted(reports - wanted):
            problems.append(f"line {start + report[0] - len(header) - 1}: {report[1]} {report[2]} without a mark")
        seen |= reports
        broken = {line for line, severity, _ in reports if severity == "error"}
        if problems or not broken or word:
            break
        for line in broken:
            text[line - 1] = ""
    for line, severity, code in sorted(wanted - seen):
        problems.append(f"line {start + line - len(header) - 1}: no {severity} {code}")
    if not problems and printed != expected and not (word and seen):
        problems.append(f"line {start}: printed\n{printed}instead of\n{expected}")
    return problems


def main():
    program, path = sys.argv[1:3]
    n_passed = n_failed = 0
    for start, word, lines in blocks(open(path, encoding="utf-8").read()):
        problems = check(program, start, word, lines)
        n_passed += not problems
        n_failed += bool(problems)
        for problem in problems:
            print(f"not ok - {os.path.basename(path)}, " + problem.replace("\n", "\n#   "))
    print(f"{n_passed} passed, {n_failed} failed")
    return n_failed > 0


if __name__ == "__main__":
    sys.exit(main())
