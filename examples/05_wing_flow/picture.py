#!/usr/bin/python3
"""Draws a flow that OpenFOAM computed on a half wing: pressure coefficient on the wall, seen from above, and speed in the
symmetry plane.

    picture.py CASE/case.foam PICTURE.png"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import render  # noqa: E402  (starts this program again inside of a virtual display where there is none)
import numpy as np  # noqa: E402
import vtk  # noqa: E402
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402


def patches(case, names):
    """The named patches with the cell fields of the last time, as one surface."""
    reader = vtk.vtkOpenFOAMReader()
    reader.SetFileName(case)
    reader.CreateCellToPointOff()
    reader.UpdateInformation()
    reader.DisableAllPatchArrays()
    for i in range(reader.GetNumberOfPatchArrays()):
        if reader.GetPatchArrayName(i).split("/")[-1] in names:
            reader.SetPatchArrayStatus(reader.GetPatchArrayName(i), 1)
    times = reader.GetTimeValues()
    reader.UpdateTimeStep(times.GetValue(times.GetNumberOfTuples() - 1))
    gather = vtk.vtkCompositeDataGeometryFilter()
    gather.SetInputConnection(reader.GetOutputPort())
    gather.Update()
    return gather.GetOutput()


def with_cell_field(surface, name, values):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    surface.GetCellData().AddArray(array)
    return name, "cells", (float(values.min()), float(values.max()))


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: picture.py CASE/case.foam PICTURE.png")
    wall, plane = patches(sys.argv[1], ("upper", "lower", "tip")), patches(sys.argv[1], ("symmetry",))
    pressure = 2 * vtk_to_numpy(wall.GetCellData().GetArray("p"))  # the far field's speed is 1
    speed = np.linalg.norm(vtk_to_numpy(plane.GetCellData().GetArray("U")), axis=1)
    window, left, right = render.two_halves("1800x800")
    render.show(left, wall, with_cell_field(wall, "pressure coefficient", pressure), "wing, from above")
    render.show(right, plane, with_cell_field(plane, "speed", speed), "symmetry plane")
    bounds = np.array(wall.GetBounds()).reshape(3, 2)
    centre, extent = bounds.mean(axis=1), np.ptp(bounds, axis=1)
    render.aim(left, centre, (-0.3, -0.2, 1), 0.55 * float(np.linalg.norm(extent)))
    render.aim(right, (0.5, 0, 0), (0, -1, 0), 0.6)  # root chord 1
    render.write_picture(window, sys.argv[2])


main()
