"""Writes a VTU file again as other programs do: rewrite_vtu.py IN FOLDER FORM...; makes FOLDER/FORM.vtu
FORM: vtk-ascii, vtk-binary, vtk-appended-raw, vtk-appended-base64, each also with -zlib or -64; meshio-ascii,
meshio-binary, meshio-zlib"""
import sys


def with_vtk(source, target, form):
    import vtk
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(source)
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputConnection(reader.GetOutputPort())
    writer.SetFileName(target)
    writer.SetCompressorTypeToNone()
    if "zlib" in form:
        writer.SetCompressorTypeToZLib()
    if "64" in form.split("-"):
        writer.SetHeaderTypeToUInt64()
    if "ascii" in form:
        writer.SetDataModeToAscii()
    elif "binary" in form:
        writer.SetDataModeToBinary()
    else:
        writer.SetDataModeToAppended()
        writer.SetEncodeAppendedData("base64" in form)
    if not writer.Write():
        sys.exit("cannot write " + target)


def with_meshio(source, target, form):
    import meshio
    mesh = meshio.read(source)
    meshio.vtu.write(target, mesh, binary=form != "meshio-ascii", compression="zlib" if "zlib" in form else None)


for name in sys.argv[3:]:
    (with_vtk if name.startswith("vtk") else with_meshio)(sys.argv[1], f"{sys.argv[2]}/{name}.vtu", name)
