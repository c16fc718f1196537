#!/bin/bash
# Runs the commands of docs/tour.md as they stand there, and looks whether they do what it says:
#   tour.sh BIN SOURCE        exit code 77: skipped, OpenFOAM or numpy is missing
set -euo pipefail
bin=$1 source=$2
command -v potentialFoam >/dev/null || { echo "skipped: potentialFoam is not installed"; exit 77; }
/usr/bin/python3 -c 'import numpy' 2>/dev/null || { echo "skipped: python3 has no numpy"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
export PATH=$bin:/usr/bin:$PATH WM_PROJECT_DIR=/usr/share/openfoam
example_05_wing_flow wing.step
cp "$source/examples/05_wing_flow/cage.obj" .
ln -s "$source/examples" examples

grep -E '^    ' "$source/docs/tour.md" | sed 's/^    //' >commands.sh
[ "$(grep -cE '^(flowcage|checkMesh|potentialFoam|examples)' commands.sh)" = 5 ] || { echo "not five commands"; exit 1; }
bash -euo pipefail commands.sh >log 2>&1 || { tail -30 log; exit 1; }
says() { grep -E "$1" log | tail -1 || { echo "not said: $1"; tail -30 log; exit 1; }; }
says '^57600 hexes in 90 blocks, .* 0 inverted'
says '^Mesh OK'
says '^U of 57600 cells'
residual=$(grep -oE 'Solving for Phi, Initial residual = [^,]*' log | tail -1 | sed 's/.*= //')
echo "last initial residual of Phi: $residual"
awk -v r="$residual" 'BEGIN { exit !(r > 0 && r < 1e-7) }' || { echo "not converged"; exit 1; }
