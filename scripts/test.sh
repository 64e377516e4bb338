#!/usr/bin/env bash
# test.sh: installs what is missing, builds GhostSpace and runs every test, in two builds: the optimised one, which
# users run, and one that AddressSanitizer and UndefinedBehaviorSanitizer watch. ctest's summaries come last.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-dependencies.sh"
cd "$root"

status=0
summaries=()

build() {  # PRESET
  echo "== $1"
  cmake --preset "$1" >/dev/null
  cmake --build --preset "$1"
}

run_tests() {  # PRESET: writes ctest's output to build/PRESET/ctest.log
  ctest --preset "$1" --output-log "$root/build/$1/ctest.log" >/dev/null
}

summarise() {  # PRESET STATUS
  local log=$root/build/$1/ctest.log counts
  echo "== tests of $1"
  cat "$log"
  # A test of ctest is a file; what Catch2 counts in it is cases and assertions.
  counts=$(sed -nE 's/^.*\(([0-9]+) assertions? in ([0-9]+) test cases?\).*$/\1 \2/p; s/^test cases: *([0-9]+).*$/0 \1/p; s/^assertions: *([0-9]+).*$/\1 0/p' \
    "$root/build/$1/Testing/Temporary/LastTest.log" | awk '{ a += $1; c += $2 } END { printf "%d cases, %d assertions", c, a }')
  summaries+=("$(printf '%-8s %s; %s' "$1:" "$(grep -E 'tests? passed|No tests' "$log" | tail -1)" "$counts")")
  [ "$2" -eq 0 ] || status=1
}

# The optimised tests run while the other build is made: neither keeps all cores busy to its end.
build release
run_tests release &
release_tests=$!
trap 'kill $release_tests 2>/dev/null || true' EXIT
build asan
result=0
wait $release_tests || result=$?
trap - EXIT
summarise release $result
result=0
run_tests asan || result=$?
summarise asan $result

echo
printf '%s\n' "${summaries[@]}"
exit $status
