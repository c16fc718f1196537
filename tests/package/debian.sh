#!/bin/bash
# Makes the .deb, installs it on this machine, runs what it installed, and takes it away again:
#   debian.sh BUILD SPHERE_PROGRAM CAGE        exit code 77: skipped (no root, no dpkg, or flowcage is installed)
set -euo pipefail
build=$1 sphere=$2 cage=$3
skip() { echo "skipped: $1"; exit 77; }
for tool in dpkg dpkg-shlibdeps cpack; do command -v $tool >/dev/null || skip "$tool is not installed"; done
[ "$(id -u)" = 0 ] || skip "the .deb is installed by root only"
if dpkg-query -W -f '${Status}' flowcage 2>/dev/null | grep -q installed; then skip "a flowcage is installed"; fi
work=$(mktemp -d)
trap 'dpkg --purge flowcage >/dev/null 2>&1 || true; rm -rf "$work"' EXIT

cpack --config "$build/CPackConfig.cmake" -B "$work/package" >"$work/cpack.log" 2>&1 || { cat "$work/cpack.log"; exit 1; }
deb=$(ls "$work"/package/*.deb)
dpkg-deb --info "$deb" | grep -E 'Package:|Version:|Depends:'
dpkg-deb --info "$deb" | grep 'Depends:.*libocct' >/dev/null || { echo "the libraries are no dependencies"; exit 1; }
dpkg --install "$deb" >"$work/dpkg.log" 2>&1 || { cat "$work/dpkg.log"; exit 1; }

cd "$work"
[ "$(command -v flowcage)" = /usr/bin/flowcage ]
flowcage --version | head -1
"$sphere" sphere.step
flowcage mesh sphere.step --cage "$cage" --levels 2 --tolerance 1e-3 --quiet -o sphere.vtu
flowcage quality sphere.vtu | grep '^inverted  0$' >/dev/null
[ -s /usr/share/man/man1/flowcage.1 ] || [ -s /usr/share/man/man1/flowcage.1.gz ]
dpkg --purge flowcage >/dev/null
[ ! -e /usr/bin/flowcage ]
