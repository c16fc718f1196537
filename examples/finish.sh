# Sourced by each example with FOLDER NAME: what OpenFOAM says of the case where it is installed, and a picture.
if command -v checkMesh >/dev/null; then
  WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam} checkMesh -case "$1/case" >"$1/checkMesh.log"
  grep -E "hexahedra:|Max skewness|non-orthogonality Max|Mesh OK|Failed" "$1/checkMesh.log" || true
fi
if /usr/bin/python3 -c 'import vtkmodules' 2>/dev/null; then
  /usr/bin/python3 "$root/examples/render.py" "$1/$2.vtu" "$1/$2.png"
fi
