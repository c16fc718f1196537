#!/bin/bash
# The ONERA M6 half wing with a hand-drawn cage and outer polyhedron, as in figures 2 to 4 of the paper.
#   run.sh [FOLDER]    leaves CAD, case, VTU, reports and picture in FOLDER (default build/02_onera_m6)
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
out=${1:-$root/build/02_onera_m6}
bin=$root/build/release/bin
mkdir -p "$out"

"$bin/example_02_onera_m6" "$out/m6.step"
"$bin/flowcage" mesh "$out/m6.step" --cage "$here/cage.obj" --outer "$here/outer.obj" --levels 4 --tolerance 1e-3 \
  -o "$out/case" -o "$out/m6.vtu" --json "$out/report.json" --report "$out/report.html"

source "$root/examples/finish.sh" "$out" m6
