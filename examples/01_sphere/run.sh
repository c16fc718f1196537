#!/bin/bash
# A sphere in a sphere-shaped far field: a cage of eight vertices is enough.
#   run.sh [FOLDER]    leaves CAD, case, VTU, report and picture in FOLDER (default build/01_sphere)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=${1:-$root/build/01_sphere}
bin=$root/build/release/bin
mkdir -p "$out"

"$bin/example_01_sphere" "$out/sphere.step"
"$bin/flowcage" mesh "$out/sphere.step" --cage "$here/cage.obj" --farfield sphere --farfield-size 5 --levels 4 \
  -o "$out/case" -o "$out/sphere.vtu" --json "$out/report.json"

source "$root/examples/finish.sh" "$out" sphere
