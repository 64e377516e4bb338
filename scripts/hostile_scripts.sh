#!/usr/bin/env bash
# hostile_scripts.sh [--count N] [--seed S] [--jobs J] [--asan] [--nobuild]: see usage.
set -euo pipefail

usage() {
  cat <<'TEXT'
usage: hostile_scripts.sh [--count N] [--seed S] [--jobs J] [--asan] [--nobuild]

Runs N generated worlds with hostile Scripts (2000), of the seeds S (1) to S+N-1, in J processes at once (2).
AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer watch each world in a process of its own.
  --asan     uses the preset asan, in which the tests are watched, too; the default is the watched variant of release
  --nobuild  runs the program that is there

A world that fails is kept as FOLDER/hostile/SEED.world, with the report in SEED.log. For each kind of fault:
  1. `hostile_scripts --minimise SEED.world` writes the shortest world with the same fault to SEED.world.min.
  2. `hostile_scripts --play SEED.world.min` runs it in one process, for a debugger.
  3. Fix the fault, and move the short world to tests/fuzz/corpus/app/script_worlds/ under a name that says what it is.
The same seed gives the same world as long as the generator (tests/fuzz/scripts/script_grammar.cpp, script_worlds.cpp) is the same.
Times-out depend on the machine: repeat a fault that appears once. Exit status 1 means that worlds failed.
TEXT
}

fail() { echo "hostile_scripts.sh: $1" >&2; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
count=2000 seed=1 jobs=2 build=1 preset=release
while [ $# -gt 0 ]; do
  case $1 in
    --count) count=${2:?}; shift 2 ;;
    --seed) seed=${2:?}; shift 2 ;;
    --jobs) jobs=${2:?}; shift 2 ;;
    --asan) preset=asan; shift ;;
    --nobuild) build=0; shift ;;
    --help) usage; exit 0 ;;
    *) usage >&2; exit 2 ;;
  esac
done
for number in "$count" "$seed" "$jobs"; do [[ $number =~ ^[0-9]+$ ]] || fail "expected a number, got '$number'"; done
[ "$count" -gt 0 ] && [ "$jobs" -gt 0 ] || fail "--count and --jobs are at least 1"
cd "$root"
if [ "$build" = 1 ]; then
  options=()
  [ "$preset" = asan ] || options=(-DGHOSTSPACE_WATCHED=ON)
  cmake --preset "$preset" "${options[@]}" >/dev/null
  cmake --build --preset "$preset" --target hostile_scripts
fi
program=$(find "$root/build/$preset" -name hostile_scripts -type f -perm -u+x | head -1)
[ -n "$program" ] || fail "hostile_scripts was not built"

work=$root/build/$preset/hostile
rm -rf "$work"
mkdir -p "$work"
running=()
for ((job = 0; job < jobs; ++job)); do
  first=$((count * job / jobs)) last=$((count * (job + 1) / jobs))
  [ "$last" -gt "$first" ] || continue
  "$program" --seed $((seed + first)) --count $((last - first)) --findings "$work" &
  running+=($!)
done
failed=0
for job in "${running[@]}"; do wait "$job" || failed=1; done
if compgen -G "$work/*.world" >/dev/null; then
  echo "Faults, by kind (worlds and reports in $work):"
  head -qn1 "$work"/*.log | sort | uniq -c | sort -rn
fi
exit $failed
