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
  summaries+=("$(printf '%-8s %s' "$preset:" "$(grep -E 'tests? passed|No tests' "$log" | tail -1)")")
done

echo
printf '%s\n' "${summaries[@]}"
exit $status
