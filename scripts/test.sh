#!/usr/bin/env bash
# test.sh: installs missing packages, builds GhostSpace and runs all tests in two variants. One is optimised, as for
# users. The other has AddressSanitizer and UndefinedBehaviorSanitizer. Prints CTest's summaries last.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-dependencies.sh" --cluster python3-h5py python3-netcdf4  # they write files for tests
cd "$root"

status=0
summaries=()

build() {  # TARGET
  echo "== building $1"
  cmake --build --preset release --target "$1"
}

run_tests() {  # VARIANT CTEST-OPTION...: writes ctest's output to build/release/ctest.VARIANT.log
  local variant=$1
  shift
  ctest --preset release "$@" --output-log "$root/build/release/ctest.$variant.log" >/dev/null
}

summarise() {  # VARIANT STATUS
  local log=$root/build/release/ctest.$1.log counts
  echo "== $1 tests"
  cat "$log"
  # A CTest test is a file. Catch2 counts the cases and assertions in it.
  counts=$(sed -nE 's/^.*\(([0-9]+) assertions? in ([0-9]+) test cases?\).*$/\1 \2/p; s/^test cases: *([0-9]+).*$/0 \1/p; s/^assertions: *([0-9]+).*$/\1 0/p' \
    "$root/build/release/details.$1.log" | awk '{ a += $1; c += $2 } END { printf "%d cases, %d assertions", c, a }')
  summaries+=("$(printf '%-10s %s; %s' "$1:" "$(grep -E 'tests? passed|No tests' "$log" | tail -1)" "$counts")")
  [ "$2" -eq 0 ] || status=1
}

cmake --preset release -DGHOSTSPACE_WATCHED=ON >/dev/null
# Run the optimised tests while the watched tests are built. Neither keeps all cores busy to its end.
build tests
run_tests optimised -LE watched &
optimised=$!
trap 'kill $optimised 2>/dev/null || true' EXIT
build all
result=0
wait $optimised || result=$?
trap - EXIT
cp build/release/Testing/Temporary/LastTest.log build/release/details.optimised.log
summarise optimised $result
result=0
run_tests watched -L watched || result=$?
cp build/release/Testing/Temporary/LastTest.log build/release/details.watched.log
summarise watched $result

echo
printf '%s\n' "${summaries[@]}"
exit $status
