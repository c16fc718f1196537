"""What VTK and meshio read from a mesh file: one "name value" a line. Run as: read_vtk.py vtk|meshio FILE"""
import sys

reader, path = sys.argv[1:3]


def hex_volume(p):
    """Signed volume of hexes (n, 8, 3) whose faces are cut into four triangles at the mean of their corners."""
    import numpy as np
    faces = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
    total = np.zeros(len(p))
    p = p - p.mean(axis=1, keepdims=True)
    for face in faces:
        q = p[:, face]
        m = q.mean(axis=1)
        for i in range(4):
            total += np.einsum("ij,ij->i", m, np.cross(q[:, i], q[:, (i + 1) % 4])) / 6
    return total


def print_multiblock(path, numpy_of):
    """Of a .vtm: its groups' pieces by name, the hexes' volume, and fields."""
    source = vtk.vtkXMLMultiBlockDataReader()
    errors = []
    source.AddObserver("ErrorEvent", lambda *a: errors.append(a))
    source.SetFileName(path)
    source.Update()
    data = source.GetOutput()
    if errors or data.GetNumberOfBlocks() != 2:
        sys.exit("VTK reports an error")
    points, hexes, volume, jacobians = set(), 0, 0.0, []
    for group in range(2):
        pieces = data.GetBlock(group)
        print("group:" + data.GetMetaData(group).Get(vtk.vtkCompositeDataSet.NAME()), pieces.GetNumberOfBlocks())
        for i in range(pieces.GetNumberOfBlocks()):
            piece = pieces.GetBlock(i)
            name = pieces.GetMetaData(i).Get(vtk.vtkCompositeDataSet.NAME())
            ids = numpy_of(piece.GetPointData().GetGlobalIds())
            points.update(ids.tolist())
            if group == 1:
                print("faces:" + name, piece.GetNumberOfPolys())
                print("patch:" + name, int(numpy_of(piece.GetCellData().GetArray("patchId"))[0]))
                continue
            hexes += piece.GetNumberOfCells()
            grid = vtk.vtkAppendFilter()  # hexes with their corners
            grid.SetInputData(piece)
            grid.Update()
            cells = grid.GetOutput()
            corners = numpy_of(cells.GetCells().GetConnectivityArray()).reshape(-1, 8)
            volume += float(hex_volume(numpy_of(cells.GetPoints().GetData())[corners]).sum())
            jacobians.append(numpy_of(piece.GetCellData().GetArray("scaled_jacobian")).min())
    print("points", len(points))
    print("hexes", hexes)
    print("volume", repr(volume))
    print("jacobian_min", repr(float(min(jacobians))))


def print_cgns(path, numpy_of):
    """Of a CGNS file: cells and volume of its zones. VTK names patches by their conditions, not their families."""
    source = vtk.vtkCGNSReader()
    source.SetFileName(path)
    source.UpdateInformation()
    source.EnableAllBases()
    source.Update()
    zones = vtk.vtkAppendFilter()
    walker = source.GetOutput().NewIterator()
    while not walker.IsDoneWithTraversal():
        zones.AddInputData(walker.GetCurrentDataObject())
        walker.GoToNextItem()
    zones.Update()
    cells = zones.GetOutput()
    types = numpy_of(cells.GetCellTypesArray())
    if not (types == 12).all():
        sys.exit("VTK reads cells that are no hexes")
    corners = numpy_of(cells.GetCells().GetConnectivityArray()).reshape(-1, 8)
    print("hexes", len(corners))
    print("volume", repr(float(hex_volume(numpy_of(cells.GetPoints().GetData()).astype("f8")[corners]).sum())))


if reader == "vtk":
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy as numpy_of
    if path.endswith(".cgns"):
        print_cgns(path, numpy_of)
        sys.exit()
    if path.endswith(".vtm"):
        print_multiblock(path, numpy_of)
        sys.exit()
    source = vtk.vtkXMLPolyDataReader() if path.endswith(".vtp") else vtk.vtkXMLUnstructuredGridReader()
    errors = []
    source.AddObserver("ErrorEvent", lambda *a: errors.append(a))
    source.SetFileName(path)
    source.Update()
    if errors:
        sys.exit("VTK reports an error")
    data = source.GetOutput()
    print("points", data.GetNumberOfPoints())
    ids = numpy_of(data.GetCellData().GetArray("patchId"))
    fields = data.GetFieldData()
    for i in range(fields.GetNumberOfArrays()):
        array = fields.GetArray(i)
        if array.GetName().startswith("patch:"):
            value = int(array.GetTuple1(0))
            print(array.GetName(), value)
            print("faces:" + array.GetName()[6:], int((ids == value).sum()))
    for i in range(data.GetPointData().GetNumberOfArrays()):
        array = data.GetPointData().GetArray(i)
        print("point_sum:" + array.GetName(), repr(float(numpy_of(array).astype("f8").sum())))
    if path.endswith(".vtp"):
        print("polygons", data.GetNumberOfPolys())
        triangles = vtk.vtkTriangleFilter()
        triangles.SetInputData(data)
        mass = vtk.vtkMassProperties()
        mass.SetInputConnection(triangles.GetOutputPort())
        mass.Update()
        print("volume", repr(mass.GetVolume()))
        sys.exit()
    points = numpy_of(data.GetPoints().GetData())
    types = numpy_of(data.GetCellTypesArray())
    hexes = int((types == 12).sum())
    print("hexes", hexes)
    print("quads", int((types == 9).sum()))
    connectivity = numpy_of(data.GetCells().GetConnectivityArray())[:8 * hexes].reshape(-1, 8)
    print("volume", repr(float(hex_volume(points[connectivity]).sum())))
    for name in [data.GetCellData().GetArrayName(i) for i in range(data.GetCellData().GetNumberOfArrays())]:
        values = numpy_of(data.GetCellData().GetArray(name)).astype("f8")
        print("cell_min:" + name, repr(float(values[:hexes].min())))
        print("quad_sum:" + name, repr(float(values[hexes:].sum())))
    quality = vtk.vtkMeshQuality()
    quality.SetInputData(data)
    quality.SetHexQualityMeasureToScaledJacobian()
    quality.Update()
    values = numpy_of(quality.GetOutput().GetCellData().GetArray("Quality"))[:hexes]
    print("scaled_jacobian_min", repr(float(values.min())))
    print("scaled_jacobian_mean", repr(float(values.mean())))
else:
    import meshio
    mesh = meshio.read(path)
    print("points", len(mesh.points))
    first = 0
    for block in mesh.cells:
        print({"hexahedron": "hexes", "quad": "quads", "triangle": "triangles"}.get(block.type, block.type),
              len(block.data))
        if block.type == "hexahedron":
            print("volume", repr(float(hex_volume(mesh.points[block.data]).sum())))
    # Gmsh: physical groups by name and number; SU2: meshio counts the markers in their order.
    for tags, dimension in (("gmsh:physical", 2), ("su2:tag", None)):
        for ids, block in zip(mesh.cell_data.get(tags, []), mesh.cells):
            if block.type != "quad":
                continue
            names = {int(v[0]): name for name, v in mesh.field_data.items() if dimension in (None, int(v[1]))}
            for tag in sorted(set(ids.tolist())):
                print("faces:" + names.get(tag, "number%d" % tag), int((ids == tag).sum()))
    if "patchId" in mesh.cell_data:
        for name, value in mesh.field_data.items():
            if name.startswith("patch:"):
                print(name, int(value[0]))
                print("faces:" + name[6:], int(sum((ids == value[0]).sum() for ids in mesh.cell_data["patchId"])))
