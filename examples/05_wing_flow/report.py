#!/usr/bin/env python3
"""Sums up the flow of 05_wing_flow: residuals of the first and the last iteration, lift and drag and how much they still
change. Exit code 1 if residuals did not fall by three orders or the forces did not settle within 0.5 %.

    report.py FOLDER"""
import math
import pathlib
import re
import sys

FALL, SETTLED, LAST = 1e-3, 5e-3, 20  # of the initial residuals; of a coefficient over the last iterations
INCIDENCE, SWEEP, ASPECT_RATIO = 4, 25, 5  # degrees, degrees, span^2 / area of the whole wing


def columns(path):
    lines = path.read_text().splitlines()
    names = [line for line in lines if line.startswith("#")][-1][1:].split()
    return {name: values for name, *values in zip(
        names, *([float(x) for x in line.split()] for line in lines if line[0] != "#"))}


def main():
    folder = pathlib.Path(sys.argv[1])
    history = {}
    for field, value in re.findall(r"Solving for (\w+), Initial residual = ([\d.e+-]+)",
                                   (folder / "simpleFoam.log").read_text()):
        history.setdefault(field, []).append(float(value))
    fine = True
    iterations = len(history["p"])
    print(f"{iterations} iterations; initial residuals, largest and last:")
    for field, values in history.items():
        fell = values[-1] <= FALL * max(values)
        fine = fine and fell
        print(f"  {field:8} {max(values):.1e} {values[-1]:.1e}{'' if fell else '   did not fall'}")
    forces = columns(max(folder.glob("case/postProcessing/forces/*/*.dat")))
    for name, title in (("Cl", "lift"), ("Cd", "drag")):
        tail = forces[name][-LAST:]
        change = (max(tail) - min(tail)) / abs(tail[-1])
        fine = fine and change <= SETTLED
        print(f"{title} coefficient {tail[-1]:.4f}, changed by {100 * change:.2f} % in the last {len(tail)} iterations")
    # Helmbold's equation for a swept wing; Polhamus: tan^2 of the half-chord line's sweep.
    half_chord = math.tan(math.radians(SWEEP)) - 0.4 / (2 * 2)
    slope = 2 * math.pi * ASPECT_RATIO / (2 + math.sqrt(4 + ASPECT_RATIO**2 * (1 + half_chord**2)))
    print(f"lift by Helmbold's equation {slope * math.radians(INCIDENCE):.4f}")
    return 0 if fine else 1


sys.exit(main())
