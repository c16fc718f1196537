#!/bin/bash
# A torus in a torus-shaped far field: cages of any genus work, as long as both have the same.
#   run.sh [FOLDER]    leaves CAD, case, VTU, report and picture in FOLDER (default build/03_torus)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=${1:-$root/build/03_torus}
bin=$root/build/release/bin
mkdir -p "$out"

"$bin/example_03_torus" "$out/torus.step"
"$bin/flowcage" mesh "$out/torus.step" --cage "$here/cage.obj" --outer "$here/outer.obj" --levels 4 \
  -o "$out/case" -o "$out/torus.vtu" --json "$out/report.json"

source "$root/examples/finish.sh" "$out" torus
