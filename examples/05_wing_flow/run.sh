#!/bin/bash
# A swept half wing, meshed and flown: simpleFoam with the Spalart-Allmaras model at Reynolds number 1e6 and 4 degrees of
# incidence. Prints residuals, lift and drag; exit code 1 if they did not settle.
#   run.sh [FOLDER] [LEVELS]    leaves CAD, case with the flow, VTU and pictures in FOLDER (default build/05_wing_flow)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=${1:-$root/build/05_wing_flow}
bin=$root/build/release/bin
mkdir -p "$out"

"$bin/example_05_wing_flow" "$out/wing.step"
"$bin/flowcage" mesh "$out/wing.step" --cage "$here/cage.obj" --symmetry y --farfield sphere --farfield-size 10 \
  --levels "${2:-3}" --first-height 0.001 --growth 1.25 -o "$out/case" -o "$out/wing.vtu" --json "$out/report.json"
source "$root/examples/finish.sh" "$out" wing

if ! command -v simpleFoam >/dev/null; then
  echo "05_wing_flow: OpenFOAM is not installed (Debian: apt-get install openfoam): no flow"
  exit 0
fi
export WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam}
cp -r "$here/case/." "$out/case"
rm -rf "$out/case/postProcessing"
simpleFoam -case "$out/case" >"$out/simpleFoam.log"
if /usr/bin/python3 -c 'import vtkmodules' 2>/dev/null; then
  /usr/bin/python3 "$here/picture.py" "$out/case/case.foam" "$out/flow.png"
fi
python3 "$here/report.py" "$out"
