#!/usr/bin/env bash
# mutate_streams.sh [--seed N] [--nobuild] COUNT: gives COUNT mutations of the streams in tests/qnv/vectors and
# tests/fuzz/corpus/qnv to all that reads QNV, watched by AddressSanitizer and UndefinedBehaviorSanitizer
# (tests/fuzz/stream_mutations.cpp says how they are made). An input that ends the program, or takes ten seconds of the
# processor or 2 GB, is kept as build/release/mutations/findings/N.qnv with what was said of it, and the rest goes on.
# Fails when there are any: mend them, and move the files to the corpora under names that say what they are.
set -euo pipefail

fail() { echo "mutate_streams.sh: $1" >&2; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
seed=1 build=1
while [[ ${1:-} == --* ]]; do
  case $1 in
    --seed) seed=${2:?}; shift 2 ;;
    --nobuild) build=0; shift ;;
    *) fail "unknown option $1" ;;
  esac
done
count=${1:-100000}
[[ $count =~ ^[0-9]+$ && $count -gt 0 ]] || fail "expected a number of mutations, got '$count'"
cd "$root"
if [ "$build" = 1 ]; then
  cmake --preset release -DGHOSTSPACE_WATCHED=ON >/dev/null
  cmake --build --preset release --target stream_mutations
fi

work=$root/build/release/mutations
program=$(find "$root/build/release" -name stream_mutations -type f -perm -u+x | head -1)
[ -n "$program" ] || fail "stream_mutations was not built"
rm -rf "$work"
mkdir -p "$work/findings"
export ASAN_OPTIONS=detect_leaks=1:hard_rss_limit_mb=2048:max_allocation_size_mb=1024:malloc_context_size=8
export UBSAN_OPTIONS=print_stacktrace=1
first=0 findings=0
while [ "$first" -lt "$count" ]; do
  status=0
  "$program" "$count" "$seed" "$first" "$work/input.qnv" "$work/number" tests/qnv/vectors tests/fuzz/corpus/qnv \
    2>"$work/said" || status=$?
  [ "$status" -ne 0 ] || break
  [ "$status" -ne 2 ] || { cat "$work/said"; exit 2; }
  ended=$(cat "$work/number")
  cp "$work/input.qnv" "$work/findings/$ended.qnv"
  { echo "exit status $status"; cat "$work/said"; } >"$work/findings/$ended.txt"
  findings=$((findings + 1))
  echo "mutation $ended ended the program: $(grep -m1 -E 'ERROR|runtime error' "$work/said" || echo "exit status $status")"
  first=$((ended + 1))
done
echo "$count mutations, $findings findings"
[ "$findings" -eq 0 ]
