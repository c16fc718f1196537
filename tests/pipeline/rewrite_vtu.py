"""Writes a VTU file again as other programs do: rewrite_vtu.py IN OUT FORM
FORM: vtk-ascii, vtk-binary, vtk-appended-raw, vtk-appended-base64, each also with -zlib or -64; meshio-ascii,
meshio-binary, meshio-zlib"""
import sys

source, target, form = sys.argv[1:4]
if form.startswith("vtk"):
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
    sys.exit(0 if writer.Write() else 1)
import meshio
mesh = meshio.read(source)
meshio.vtu.write(target, mesh, binary=form != "meshio-ascii", compression="zlib" if "zlib" in form else None)
