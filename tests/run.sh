#!/bin/bash
# Everything that is checked before a change is accepted, from a fresh machine on: installs what is missing, checks
# the format, builds, runs the tests and the static checks, and sums up.
#   ./tests/run.sh           all of it
#   ./tests/run.sh --quick   without the slow tests
#   ./tests/run.sh --tidy    and clang-tidy over the files that differ from main
set -uo pipefail
cd "$(dirname "$0")/.."

quick=
tidy=
for argument in "$@"; do
  case $argument in
    --quick) quick=1 ;;
    --tidy) tidy=1 ;;
    *) echo "usage: $0 [--quick] [--tidy]" >&2; exit 2 ;;
  esac
done

build=build/release
failures=()
summary=()
section() { printf '\n== %s\n' "$1"; }
finish() {
  section summary
  printf '%s\n' "${summary[@]}"
  if ((${#failures[@]} > 0)); then
    echo "result:      FAILED (${failures[*]})"
    exit 1
  fi
  echo "result:      PASSED"
  exit 0
}
stop() {
  failures+=("$1")
  finish
}

section packages
./install-packages.sh build test || stop packages

section format
mapfile -t sources < <(find core occ_bridge cli examples tests -name '*.cpp' -o -name '*.hpp' | sort)
if ! command -v clang-format >/dev/null; then
  summary+=("format:      skipped, clang-format is missing")
elif clang-format --dry-run -Werror "${sources[@]}"; then
  summary+=("format:      ${#sources[@]} files, as .clang-format says")
else
  summary+=("format:      wrong, run clang-format -i on the files above")
  failures+=(format)
fi

section build
cmake --preset release && cmake --build --preset release || stop build
summary+=("build:       release, warnings are errors")

section tests
log=$build/Testing/tests.log
mkdir -p "$(dirname "$log")"
ctest --preset release --parallel "$(nproc)" --verbose ${quick:+--label-exclude slow} >"$log" 2>&1
code=$?
# Of a verbose run only the verdicts, and all that failed.
grep -E '^ *[0-9]+/[0-9]+ Test ' "$log"
total=$(grep -cE '^ *[0-9]+/[0-9]+ Test ' "$log")
failed=$(grep -E '^ *[0-9]+/[0-9]+ Test ' "$log" | grep -cvE 'Passed|Skipped')
skipped=$(grep -cE '^ *[0-9]+/[0-9]+ Test .*Skipped' "$log")
cases=$(sed -nE 's/.*All tests passed \([0-9]+ assertions? in ([0-9]+) test cases?\).*/\1/p; s/.*test cases: *([0-9]+) \|.*/\1/p' "$log" |
  awk '{ n += $1 } END { print n + 0 }')
assertions=$(sed -nE 's/.*All tests passed \(([0-9]+) assertions?.*/\1/p; s/.*assertions: *([0-9]+) \|.*/\1/p' "$log" |
  awk '{ n += $1 } END { print n + 0 }')
if ((code != 0 || total == 0)); then
  failures+=(tests)
  grep -E '^ *[0-9]+/[0-9]+ Test ' "$log" | grep -vE 'Passed|Skipped' | sed -E 's/^ *[0-9]+\/[0-9]+ Test +#([0-9]+):.*/\1/' |
    while read -r number; do grep -E "^ *$number: " "$log" | tail -60; done
fi
summary+=("tests:       $total programs ($cases test cases, $assertions assertions)${quick:+, without the slow ones}")
summary+=("passed:      $((total - failed - skipped))")
summary+=("failed:      $failed")
summary+=("skipped:     $skipped programs")
# A test that leaves out a part prints "skipped: WHY".
while read -r line; do summary+=("skipped:     $line"); done < <(sed -nE 's/^ *[0-9]+: *[Ss]kipped: *//p' "$log" | sort -u)

if [ -z "$tidy" ]; then
  summary+=("clang-tidy:  not run (--tidy)")
else
  section "static checks"
  if ! command -v clang-tidy >/dev/null; then
    summary+=("clang-tidy:  skipped, clang-tidy is missing")
  elif checked=$(./tests/tidy.sh 2>&1); then
    summary+=("clang-tidy:  $(tail -1 <<<"$checked")")
  else
    echo "$checked"
    summary+=("clang-tidy:  complaints above")
    failures+=(clang-tidy)
  fi
fi
finish
