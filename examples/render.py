#!/usr/bin/python3
"""Draws a VTU mesh of flowcage into a PNG, without a display: on the left the wall patches with their mesh lines,
on the right the mesh in the symmetry plane (or, without one, the cells cut by a plane through the body).

    render.py MESH.vtu PICTURE.png [--field NAME] [--wall PATCH ...] [--plane x|y|z[=VALUE]] [--view DX,DY,DZ]

Needs VTK for Python (Debian: python3-vtk9) and, where there is no display, xvfb-run (Debian: xvfb, xauth)."""
import argparse
import os
import shutil
import sys


def restart_with_display():
    """VTK of Debian draws only with an X server: start this program again inside of a virtual one."""
    if os.environ.get("DISPLAY") or os.environ.get("RENDER_RESTARTED"):
        return
    if not shutil.which("xvfb-run"):
        sys.exit("render.py: no display, and no xvfb-run to make one (Debian: apt-get install xvfb xauth)")
    os.environ["RENDER_RESTARTED"] = "1"
    os.execvp("xvfb-run", ["xvfb-run", "-a", "-s", "-screen 0 1920x1200x24", sys.executable] + sys.argv)


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("mesh")
    parser.add_argument("picture")
    parser.add_argument("--field", help="cell or point field on the left (default: deviation, else scaled_jacobian)")
    parser.add_argument("--wall", nargs="+", help="patches on the left (default: those of type wall)")
    parser.add_argument("--plane", help="cut of the right picture (default: the symmetry patch)")
    parser.add_argument("--view", default="-1,-1,0.7", help="from where the left picture looks (default: %(default)s)")
    parser.add_argument("--size", default="1800x800", help="in pixels (default: %(default)s)")
    return parser.parse_args()


restart_with_display()
import numpy as np  # noqa: E402  (after the restart: importing VTK twice takes seconds)
import vtk  # noqa: E402
from vtk.util.numpy_support import vtk_to_numpy  # noqa: E402

WALL, SYMMETRY = 0, 2  # PatchType as in the file's patchTypes


def read(path):
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    if not os.path.isfile(path) or not reader.CanReadFile(path):
        sys.exit(f"render.py: {path}: is no readable VTU file")
    reader.Update()
    mesh = reader.GetOutput()
    if not mesh.GetCellData().HasArray("patchId"):
        sys.exit(f"render.py: {path}: has no cell array patchId: give a VTU file that flowcage wrote")
    return mesh


def patches_of(mesh):
    """Patch ids by name, and the type of each id."""
    fields = mesh.GetFieldData()
    names, types = {}, {}
    for i in range(fields.GetNumberOfArrays()):
        array = fields.GetArray(i)
        if array and array.GetName().startswith("patch:"):
            names[array.GetName()[6:]] = int(array.GetTuple1(0))
    if fields.HasArray("patchTypes"):
        types = dict(enumerate(int(t) for t in vtk_to_numpy(fields.GetArray("patchTypes"))))
    return names, types


def cells_where(mesh, keep):
    """The cells whose number is in `keep`, as a surface."""
    ids = vtk.vtkIdTypeArray()
    for i in keep:
        ids.InsertNextValue(int(i))
    node = vtk.vtkSelectionNode()
    node.SetFieldType(vtk.vtkSelectionNode.CELL)
    node.SetContentType(vtk.vtkSelectionNode.INDICES)
    node.SetSelectionList(ids)
    selection = vtk.vtkSelection()
    selection.AddNode(node)
    extract = vtk.vtkExtractSelection()
    extract.SetInputData(0, mesh)
    extract.SetInputData(1, selection)
    surface = vtk.vtkDataSetSurfaceFilter()
    surface.SetInputConnection(extract.GetOutputPort())
    surface.Update()
    return surface.GetOutput()


def cut_by_plane(mesh, axis, value, hexes):
    """The hexes that a plane goes through (whole cells: their true shape shows)."""
    points = vtk_to_numpy(mesh.GetPoints().GetData())[:, axis]
    corners = points[vtk_to_numpy(mesh.GetCells().GetConnectivityArray())[: 8 * hexes].reshape(-1, 8)]
    low, high = corners.min(axis=1), corners.max(axis=1)
    return cells_where(mesh, np.flatnonzero((low <= value) & (value < high)))


def choose_field(surface, wanted):
    for name in [wanted] if wanted else ["deviation", "scaled_jacobian"]:
        for data, place in ((surface.GetCellData(), "cells"), (surface.GetPointData(), "points")):
            if data.HasArray(name):
                values = vtk_to_numpy(data.GetArray(name))
                values = values[np.isfinite(values)]
                if len(values):
                    return name, place, (float(values.min()), float(values.max()))
    if wanted:
        sys.exit(f"render.py: the file has no field {wanted} on these patches")
    return None, None, None


def show(renderer, surface, field, title):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    name, place, limits = field
    if name is None:
        mapper.ScalarVisibilityOff()
    else:
        (mapper.SetScalarModeToUseCellFieldData if place == "cells" else mapper.SetScalarModeToUsePointFieldData)()
        mapper.SelectColorArray(name)
        table = vtk.vtkLookupTable()
        # Blue is good: a small deviation, a scaled Jacobian of 1.
        table.SetHueRange(*((0.0, 0.62) if name == "scaled_jacobian" else (0.62, 0.0)))
        table.SetSaturationRange(0.55, 0.55)
        table.Build()
        mapper.SetLookupTable(table)
        mapper.SetScalarRange(*((0.0, 1.0) if name == "scaled_jacobian" else limits))
        mapper.UseLookupTableScalarRangeOff()
        bar = vtk.vtkScalarBarActor()
        bar.SetLookupTable(table)
        bar.SetTitle(name.replace("_", " "))
        bar.SetLabelFormat("%.2g")
        bar.SetNumberOfLabels(5)
        bar.SetOrientationToHorizontal()
        bar.SetPosition(0.2, 0.02)
        bar.SetWidth(0.6)
        bar.SetHeight(0.09)
        bar.DrawBackgroundOn()
        bar.GetBackgroundProperty().SetColor(1, 1, 1)
        for text in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
            text.SetColor(0.1, 0.1, 0.1)
            text.ItalicOff()
            text.ShadowOff()
        renderer.AddActor2D(bar)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().EdgeVisibilityOn()
    actor.GetProperty().SetEdgeColor(0.15, 0.15, 0.2)
    actor.GetProperty().SetLineWidth(1)
    actor.GetProperty().SetAmbient(0.45)  # colours, not shades, are to be read
    actor.GetProperty().SetDiffuse(0.55)
    actor.GetProperty().SetColor(0.75, 0.8, 0.85)
    renderer.AddActor(actor)
    label = vtk.vtkTextActor()
    label.SetInput(title)
    label.GetTextProperty().SetFontSize(22)
    label.GetTextProperty().SetColor(0.1, 0.1, 0.1)
    label.GetTextProperty().SetBackgroundColor(1, 1, 1)
    label.GetTextProperty().SetBackgroundOpacity(1)
    label.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    label.SetPosition(0.02, 0.94)
    renderer.AddActor2D(label)


def aim(renderer, focus, direction, reach):
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(*focus)
    direction = np.asarray(direction, float) / np.linalg.norm(direction)
    camera.SetPosition(*(np.asarray(focus) + 10 * reach * direction))
    camera.SetViewUp(*((0, 1, 0) if abs(direction[2]) > 0.9 else (0, 0, 1)))
    camera.SetParallelScale(reach)
    renderer.ResetCameraClippingRange()


def two_halves(size):
    """A window "WIDTHxHEIGHT" and its left and right renderer."""
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetSize(*(int(n) for n in size.split("x")))
    window.SetMultiSamples(8)
    left, right = vtk.vtkRenderer(), vtk.vtkRenderer()
    for renderer, area in ((left, (0, 0, 0.5, 1)), (right, (0.5, 0, 1, 1))):
        renderer.SetViewport(*area)
        renderer.SetBackground(1, 1, 1)
        window.AddRenderer(renderer)
    return window, left, right


def write_picture(window, path):
    window.Render()
    capture = vtk.vtkWindowToImageFilter()
    capture.SetInput(window)
    capture.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputConnection(capture.GetOutputPort())
    writer.Write()
    if not os.path.isfile(path):
        sys.exit(f"render.py: cannot write {path}")


def main():
    args = parse_arguments()
    mesh = read(args.mesh)
    names, types = patches_of(mesh)
    ids = vtk_to_numpy(mesh.GetCellData().GetArray("patchId"))
    cell_types = vtk_to_numpy(mesh.GetCellTypesArray())
    hexes = int((cell_types == 12).sum())
    for name in args.wall or []:
        if name not in names:
            sys.exit(f"render.py: there is no patch {name}: there are {', '.join(names)}")
    walls = [names[n] for n in args.wall] if args.wall else [i for i, t in types.items() if t == WALL]
    if not walls:
        walls = sorted(names.values())
    wall = cells_where(mesh, np.flatnonzero(np.isin(ids, walls)))
    if wall.GetNumberOfCells() == 0:
        sys.exit("render.py: the wall patches have no faces")
    bounds = np.array(wall.GetBounds()).reshape(3, 2)
    centre, extent = bounds.mean(axis=1), np.ptp(bounds, axis=1)

    symmetry = [i for i, t in types.items() if t == SYMMETRY]
    if args.plane:
        axis = "xyz".index(args.plane[0])
        value = float(args.plane[2:]) if len(args.plane) > 1 else centre[axis]
        cut, title = cut_by_plane(mesh, axis, value, hexes), f"cells cut by {'xyz'[axis]} = {value:.4g}"
    elif symmetry:
        cut, title = cells_where(mesh, np.flatnonzero(np.isin(ids, symmetry))), "symmetry plane"
        axis = int(np.argmin(np.ptp(np.array(cut.GetBounds()).reshape(3, 2), axis=1)))
    else:
        axis = int(np.argmin(extent))
        cut, title = cut_by_plane(mesh, axis, centre[axis], hexes), f"cells cut by {'xyz'[axis]} = {centre[axis]:.4g}"

    window, left, right = two_halves(args.size)
    show(left, wall, choose_field(wall, args.field), f"{wall.GetNumberOfCells():,} wall faces")
    show(right, cut, choose_field(cut, "scaled_jacobian" if cut.GetCellData().HasArray("scaled_jacobian") else None),
         f"{hexes:,} hexes, {title}")
    aim(left, centre, [float(c) for c in args.view.split(",")], 0.55 * float(np.linalg.norm(extent)))
    normal = np.zeros(3)
    normal[axis] = -1 if axis == 1 else 1
    in_plane = np.delete(extent, axis)
    aim(right, centre, normal, 0.75 * float(max(in_plane)))

    write_picture(window, args.picture)


if __name__ == "__main__":
    main()
