#!/bin/bash
# Installs a build into a fresh prefix and lets a stranger's project, made of the code blocks of docs/library.md, find,
# compile and run it:   stranger.sh BUILD SOURCE SPHERE_PROGRAM
set -euo pipefail
build=$1 source=$2 sphere=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
block() { awk -v from="^\`\`\`$1\$" '$0 ~ from {on = 1; next} /^```$/ {on = 0} on' "$source/docs/library.md"; }

cmake --install "$build" --prefix "$work/prefix" >"$work/install.log"
for file in bin/flowcage share/man/man1/flowcage.1 share/bash-completion/completions/flowcage \
  share/zsh/vendor-completions/_flowcage share/fish/vendor_completions.d/flowcage.fish; do
  [ -s "$work/prefix/$file" ] || { echo "not installed: $file"; exit 1; }
done
"$work/prefix/bin/flowcage" --version | grep '^flowcage [0-9]' >/dev/null

mkdir "$work/project" "$work/run"
block cmake >"$work/project/CMakeLists.txt"
block cpp >"$work/project/main.cpp"
cmake -S "$work/project" -B "$work/project/build" -DCMAKE_PREFIX_PATH="$work/prefix" -DCMAKE_BUILD_TYPE=Debug \
  >"$work/configure.log" 2>&1 || { cat "$work/configure.log"; exit 1; }
grep -q "flowcage_DIR:PATH=$work/prefix" "$work/project/build/CMakeCache.txt" || { echo "found another flowcage"; exit 1; }
cmake --build "$work/project/build" >"$work/build.log" 2>&1 || { cat "$work/build.log"; exit 1; }

cd "$work/run"
"$sphere" wing.step
cp "$source/examples/01_sphere/cage.obj" cage.obj
"$work/project/build/mesh_wing"
"$work/prefix/bin/flowcage" quality wing.vtu | grep -E '^(cells|inverted|checkMesh)'
"$work/prefix/bin/flowcage" quality wing.vtu | grep '^inverted  0$' >/dev/null
