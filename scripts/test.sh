#!/usr/bin/env bash
# test.sh: installs what is missing, builds GhostSpace and runs every test, in two builds: the optimised one, which
# users run, and one that AddressSanitizer and UndefinedBehaviorSanitizer watch. ctest's summaries come last.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-dependencies.sh"
cd "$root"

status=0
summaries=()
for preset in release asan; do
  echo "== $preset"
  cmake --preset "$preset" >/dev/null
  cmake --build --preset "$preset"
  log=$root/build/$preset/ctest.log
  ctest --preset "$preset" --progress --output-log "$log" || status=1
  # A test of ctest is a file; what Catch2 counts in it is cases and assertions.
  counts=$(sed -nE 's/^.*\(([0-9]+) assertions? in ([0-9]+) test cases?\).*$/\1 \2/p; s/^test cases: *([0-9]+).*$/0 \1/p; s/^assertions: *([0-9]+).*$/\1 0/p' \
    "$root/build/$preset/Testing/Temporary/LastTest.log" | awk '{ a += $1; c += $2 } END { printf "%d cases, %d assertions", c, a }')
  summaries+=("$(printf '%-8s %s; %s' "$preset:" "$(grep -E 'tests? passed|No tests' "$log" | tail -1)" "$counts")")
done

echo
printf '%s\n' "${summaries[@]}"
exit $status
