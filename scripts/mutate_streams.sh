#!/usr/bin/env bash
# mutate_streams.sh [--seed N] [--jobs N] [--nobuild] COUNT: makes COUNT mutations of the streams in tests/qnv/vectors
# and tests/fuzz/corpus/qnv. Passes them to all code that reads QNV, with AddressSanitizer and
# UndefinedBehaviorSanitizer, in N processes at once (1). tests/fuzz/mutations/stream_mutator.h describes the mutations.
#
# An input is a finding if it ends the program, or takes ten processor seconds or 2 GB. It is kept with its messages as
# build/release/mutations/findings/N.qnv, and the run continues. The script fails if there are findings. After a fix,
# move the files to the corpora. Their new names must say what they are.
set -euo pipefail

fail() { echo "mutate_streams.sh: $1" >&2; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
seed=1 build=1 jobs=1
while [[ ${1:-} == --* ]]; do
  case $1 in
    --seed) seed=${2:?}; shift 2 ;;
    --jobs) jobs=${2:?}; shift 2 ;;
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

# Runs a range of mutations. If a mutation ends the program, continues after that mutation.
run_range() {
  local first=$1 last=$2 status ended
  local input=$work/input.$1.qnv number=$work/number.$1 said=$work/said.$1
  while [ "$first" -lt "$last" ]; do
    status=0
    "$program" "$last" "$seed" "$first" "$input" "$number" tests/qnv/vectors tests/fuzz/corpus/qnv 2>"$said" || status=$?
    [ "$status" -ne 0 ] || break
    [ "$status" -ne 2 ] || { cat "$said"; return 2; }
    ended=$(cat "$number" 2>/dev/null || true)
    # If the number has not changed, the mutator itself failed and would fail again.
    [[ $ended =~ ^[0-9]+$ && $ended -ge $first ]] || { cat "$said"; return 2; }
    cp "$input" "$work/findings/$ended.qnv"
    { echo "exit status $status"; cat "$said"; } >"$work/findings/$ended.txt"
    echo "mutation $ended ended the program: $(grep -m1 -E 'ERROR|runtime error' "$said" || echo "exit status $status")"
    first=$((ended + 1))
  done
}
running=()
for ((job = 0; job < jobs; ++job)); do
  run_range $((count * job / jobs)) $((count * (job + 1) / jobs)) &
  running+=($!)
done
for job in "${running[@]}"; do wait "$job"; done
findings=$(find "$work/findings" -name '*.qnv' | wc -l)
echo "$count mutations, $findings findings"
[ "$findings" -eq 0 ]
