"""What VTK makes of curved cells: read_curved.py FILE ORDER. The file holds the box [0,2]x[0,1]x[0,1], a cell a unit, whose
nodes a map of degree p = ORDER moved: (x + 0.1 y^p, y + 0.05 z^p, z + 0.1 x y^(p-1)). Prints the largest distance between VTK's cells and that map at places inside, "name value" a line."""
import sys

import numpy as np
import vtk

path, order = sys.argv[1], int(sys.argv[2])
source = vtk.vtkCGNSReader() if path.endswith(".cgns") else vtk.vtkXMLUnstructuredGridReader()
errors = []
source.AddObserver("ErrorEvent", lambda *a: errors.append(a))
source.SetFileName(path)
if path.endswith(".cgns"):
    source.UpdateInformation()
    source.EnableAllBases()
source.Update()
if errors:
    sys.exit("VTK reports an error")
grid = source.GetOutput()
if path.endswith(".cgns"):
    iterator = grid.NewIterator()
    grid = iterator.GetCurrentDataObject()


def mapped(r, cell):
    """Parameters of a cell to its place."""
    x, y, z = r[0] + cell, r[1], r[2]
    return np.array([x + 0.1 * y ** order, y + 0.05 * z ** order, z + 0.1 * x * y ** (order - 1)])


def farthest(cell, number, places):
    x, weights, sub = [0.0] * 3, [0.0] * cell.GetNumberOfPoints(), vtk.reference(0)
    far = 0.0
    for r in places:
        cell.EvaluateLocation(sub, list(r), x, weights)
        far = max(far, np.linalg.norm(np.array(x) - mapped(r, number)))
    return far


def with_edges_swapped(cell):
    """VTK 9.1 changed the order of the last two edges of Lagrange hexes, but not in its reader of HEXA_64."""
    points = [cell.GetPoints().GetPoint(n) for n in range(28, 32)]
    for n, point in zip((30, 31, 28, 29), points):
        cell.GetPoints().SetPoint(n, point)
    return cell


hexes = quads = 0
worst = worst_quad = 0.0
generator = np.random.default_rng(3)
for c in range(grid.GetNumberOfCells()):
    cell = grid.GetCell(c)
    if cell.GetCellDimension() == 2 and cell.GetCellType() != vtk.VTK_EMPTY_CELL:
        quads += 1
        # A place in a quad is one in a face of a cell, in some turn.
        x, weights, sub = [0.0] * 3, [0.0] * cell.GetNumberOfPoints(), vtk.reference(0)
        for u, v in generator.random((3, 2)):
            cell.EvaluateLocation(sub, [u, v, 0], x, weights)
            nearest = min(np.linalg.norm(np.array(x) - mapped(at, owner)) for owner in range(2)
                          for a, b in ((u, v), (v, u), (1 - u, v), (u, 1 - v), (1 - u, 1 - v), (v, 1 - u), (1 - v, u),
                                       (1 - v, 1 - u))
                          for at in ((0, a, b), (1, a, b), (a, 0, b), (a, 1, b), (a, b, 0), (a, b, 1)))
            worst_quad = max(worst_quad, nearest)
        continue
    number = hexes
    hexes += 1
    if cell.GetCellType() == vtk.VTK_EMPTY_CELL and order == 4:
        print("unsupported 1")  # VTK 9.1 knows HEXA_27 and HEXA_64
        continue
    places = generator.random((40, 3))
    far = farthest(cell, number, places)
    if path.endswith(".cgns") and order == 3:
        far = min(far, farthest(with_edges_swapped(cell), number, places))
    worst = max(worst, far)
print("hexes", hexes)
print("quads", quads)
print("distance", repr(worst))
print("quad_distance", repr(worst_quad))
