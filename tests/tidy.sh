#!/bin/bash
# clang-tidy over the sources that differ from main (on main itself: from the commit before), or over all with "all".
# All takes some ten minutes of processor time: run.sh calls this without it. It reads a configuration of its own: clang cannot read GCC's precompiled headers.
set -uo pipefail
cd "$(dirname "$0")/.."

changed() {
  git rev-parse --git-dir >/dev/null 2>&1 || return 0
  local base=
  for name in origin/main main; do
    base=$(git merge-base HEAD "$name" 2>/dev/null) && break
  done
  [ "$base" != "$(git rev-parse HEAD)" ] || base=$(git rev-parse -q --verify HEAD~1 || true)
  { [ -z "$base" ] || git diff --name-only "$base"; git ls-files --others --exclude-standard; } | sort -u
}

if [ "${1:-}" = all ]; then
  mapfile -t files < <(find core occ_bridge cli examples tests -name '*.cpp' | sort)
else
  mapfile -t files < <(changed | grep -E '^(core|occ_bridge|cli|examples|tests)/.*\.cpp$' | while read -r f; do [ -f "$f" ] && echo "$f"; done)
fi
cmake -S . -B build/tidy -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DFLOWCAGE_PCH=OFF >/dev/null || exit 1
# What CMake does not build here (an optional part) cannot be checked.
compiled=()
for file in "${files[@]}"; do
  grep -qF "/$file\"" build/tidy/compile_commands.json && compiled+=("$file")
done
if ((${#compiled[@]} == 0)); then
  echo "no changed files"
  exit 0
fi
printf '%s\n' "${compiled[@]}" | xargs -P "$(nproc)" -n 4 clang-tidy -p build/tidy --quiet 2>/dev/null || exit 1
echo "clean (${#compiled[@]} files)"
