#!/bin/bash
# From a fresh Debian 12 to a mesh of the ONERA M6 half wing: installs what is missing, builds the program, meshes
# the example. The OpenFOAM case and its picture are left in build/quickstart.
set -euo pipefail
cd "$(dirname "$0")/.."

./install-packages.sh build picture
cmake --preset release >/dev/null
cmake --build --preset release --target flowcage example_02_onera_m6
./examples/02_onera_m6/run.sh build/quickstart
