#!/usr/bin/env python3
"""Reads every CAD file of a folder with `flowcage inspect` and prints a Markdown table of what was found and what it cost.

    tests/bench/cad_table.py build/release/bin/flowcage FOLDER [--manifest MANIFEST.md]

With a manifest (a Markdown table whose columns include `file`, `state` and `unit in file`) the free edges and units are
compared with it. Exit code 1 where a file costs more than 10 s of CPU time or 2 GiB, ends with another exit code than 0
(3 where the manifest calls it UNREADABLE or NO SURFACE), or differs from the manifest.
"""
import argparse
import json
import os
import re
import subprocess
import sys
import tempfile

SECONDS, BYTES = 10.0, 2 << 30
EXTENSIONS = (".step", ".stp", ".iges", ".igs", ".brep")
UNITS = {"metre": "m", "millimetre": "mm", "foot": "ft", "inch": "in", "none": ""}


def expected_states(manifest):
    """{file: (free edges or None where it must be refused, unit)}"""
    states, columns = {}, None
    for line in open(manifest, encoding="utf-8"):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if "file" in cells and "state" in cells:
            columns = {name: i for i, name in enumerate(cells)}
        elif columns and len(cells) == len(columns) and cells[0].lower().endswith(EXTENSIONS):
            state, unit = cells[columns["state"]], cells[columns["unit in file"]].lower()
            free = re.search(r"best (\d+) free", state)
            refused = state.startswith(("UNREADABLE", "NO SURFACE"))
            unit = re.sub(r"\(\d+\)", "", unit)
            states[cells[0]] = (None if refused else int(free.group(1)) if free else 0, UNITS.get(unit, unit))
    return states


def inspect(program, file):
    """Exit code, the JSON's "cad" (None if refused), first line of stderr, CPU seconds and peak bytes with its child."""
    with tempfile.TemporaryDirectory() as folder:
        report = os.path.join(folder, "report.json")
        with open(os.path.join(folder, "err"), "w+") as err:
            process = subprocess.Popen([program, "inspect", file, "--json", report], stdout=subprocess.DEVNULL, stderr=err)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            err.seek(0)
            message = err.readline().strip()
        cad = json.load(open(report))["cad"] if process.returncode == 0 else None
    return process.returncode, cad, message, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def borders(cad):
    counts = {}
    for border in cad["open_borders"]:
        counts[border["kind"]] = counts.get(border["kind"], 0) + 1
    return ", ".join(f"{count} {kind}" for kind, count in counts.items()) or "-"


def row(file, cad, seconds, size):
    faces = str(cad["sources"][0]["faces"])
    if cad["faces"] != cad["sources"][0]["faces"]:
        faces += f" -> {cad['faces']}"
    sharp = str(cad["sharp_edges"])
    if cad["partly_sharp_edges"]:
        sharp += f" ({cad['partly_sharp_edges']} in part)"
    free = f"{cad['free_edges_before_sewing']} -> {cad['free_edges_before_splitting']}"
    if cad["free_edges"] != cad["free_edges_before_splitting"]:
        free += f" -> {cad['free_edges']}"
    sewn = f"{cad['sewing_tolerance'] / cad['diagonal']:.0e}" if cad["sewing_tolerance"] else "-"
    cells = [file, faces, sharp, f"{cad['sharp_chains']} + {cad['boundary_chains']}", free, sewn, borders(cad),
             str(cad["solids"]), cad["unit"] or "none", f"{seconds:.1f}", f"{size / (1 << 20):.0f}"]
    return "| " + " | ".join(cells) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("folder")
    parser.add_argument("--manifest")
    arguments = parser.parse_args()
    expected = expected_states(arguments.manifest) if arguments.manifest else {}
    problems = []
    print("| file | faces as read -> after splits and strips | sharp edges | chains sharp + open "
          "| free edges: read -> sewn -> split | sewn at | open borders | solids | unit | CPU s | MiB |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for file in sorted(os.listdir(arguments.folder)):
        if not file.lower().endswith(EXTENSIONS):
            continue
        code, cad, message, seconds, size = inspect(arguments.program, os.path.join(arguments.folder, file))
        free, unit = expected.get(file, (cad and cad["free_edges_before_splitting"], cad and cad["unit"]))
        if seconds > SECONDS or size > BYTES:
            problems.append(f"{file}: {seconds:.1f} s, {size / (1 << 20):.0f} MiB")
        if cad is None:
            why = message.split(": ", 2)[-1]
            print(f"| {file} | refused (exit {code}): {why} | | | | | | | | {seconds:.1f} | {size / (1 << 20):.0f} |")
            if free is not None or code != 3:
                problems.append(f"{file}: exit code {code}, {message}")
            continue
        print(row(file, cad, seconds, size))
        if free is None:
            problems.append(f"{file}: was to be refused")
        elif free != cad["free_edges_before_splitting"]:
            problems.append(f"{file}: {cad['free_edges_before_splitting']} free edges after sewing, the manifest says {free}")
        if unit != cad["unit"]:
            problems.append(f"{file}: unit {cad['unit']}, the manifest says {unit}")
    for problem in problems:
        print(problem, file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
