#!/usr/bin/env bash
# fuzz.sh [--jobs N] [--nobuild] MINUTES [TARGET...]: builds the libFuzzer programs with clang and divides MINUTES among
# all targets of tests/fuzz, N at a time (1). There is a target for each row of the tables of content types, volumes and
# images, and for each kind of network data.
#
# A target starts from its corpus in tests/fuzz/corpus, from findings of earlier runs, and from a dictionary of the
# words in its corpus. Prints a table. Keeps findings in build/fuzz/findings/ROOM/TARGET and then fails. After a fix,
# move the file to the corpus of the target. Its new name must say what it is.
set -euo pipefail

fail() { echo "fuzz.sh: $1" >&2; exit 2; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
jobs=1 build=1
while [[ ${1:-} == --* ]]; do
  case $1 in
    --jobs) jobs=${2:?}; shift 2 ;;
    --nobuild) build=0; shift ;;
    *) fail "unknown option $1" ;;
  esac
done
minutes=${1:-10}
[[ $minutes =~ ^[0-9]+$ && $minutes -gt 0 ]] || fail "expected a number of minutes, got '$minutes'"
[ $# -eq 0 ] || shift
wanted=" $* "
rooms=(vrml qnv net render app)
cd "$root"
if [ "$build" = 1 ]; then
  "$root/scripts/install-dependencies.sh" clang libclang-rt-14-dev
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz --target ghostspace "${rooms[@]/%/_fuzz}"
fi

export fuzz=$root/build/fuzz corpora=$root/tests/fuzz/corpus
results=$fuzz/results
rm -rf "$results"
mkdir -p "$results"
targets=()
for room in "${rooms[@]}"; do
  while read -r name most; do
    [[ $wanted == "  " || $wanted == *" $name "* || $wanted == *" $room "* ]] && targets+=("$room $name $most")
  done < <("$fuzz/tests/${room}_fuzz" --list)
done
[ ${#targets[@]} -gt 0 ] || fail "no target of these names:$wanted"
export seconds=$((minutes * 60 * jobs / ${#targets[@]})) results
[ "$seconds" -gt 0 ] || export seconds=1
echo "${#targets[@]} targets, $seconds seconds each, $jobs at once"

# Fuzzes one target until its time is over. A finding ends a run of libFuzzer; then another run begins.
run_target() {
  local room=$1 name=$2 most=$3
  local work=$fuzz/inputs/$room/$name found=$fuzz/findings/$room/$name log=$results/$room.$name.log
  local seeds=("$corpora/$room/$name") dictionary=$fuzz/inputs/$room.$name.dict
  mkdir -p "$work" "$found"
  [ "$room" != vrml ] || seeds+=("$root/tests/vrml/good" "$root/tests/vrml/bad")
  {
    find "${seeds[@]}" -type f -exec grep -aohE '[A-Za-z_][A-Za-z0-9_:.-]{1,30}' {} +
    # Add each name of the node table, and the keywords of Annex A.
    if [[ $name == worlds || $name == vrml97 ]]; then
      "$fuzz/ghostspace" nodes --wrl | grep -oE '[A-Za-z][A-Za-z0-9_]+'
      printf '%s\n' DEF USE ROUTE TO PROTO EXTERNPROTO IS NULL TRUE FALSE
    fi
    printf '%s\n' '==== the other file'
  } | sort -u | head -3000 | sed 's/.*/"&"/' >"$dictionary"
  # LeakSanitizer does not see the heap of the script engine, which refers to other blocks of it. The library for JPEG
  # 2000 in DICOM loses 112 bytes after some damaged pictures.
  local leaks=1
  [[ $name != programs && $name != script_worlds && $name != control_messages && $name != dicom ]] || leaks=0
  local begin=$SECONDS runs=0 executions=0 inputs=0 peak=0 left=$seconds
  : >"$log"
  while [ "$left" -gt 0 ] && [ "$runs" -lt 20 ]; do
    "$fuzz/tests/${room}_fuzz" "--target=$name" "$work" "${seeds[@]}" "-dict=$dictionary" "-artifact_prefix=$found/" \
      "-max_total_time=$left" "-max_len=$most" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=1024 -print_final_stats=1 "-detect_leaks=$leaks" \
      >"$log.one" 2>&1 || true
    cat "$log.one" >>"$log"
    figure() { sed -n "s/^stat::$1: *//p" "$log.one" | tail -1; }
    executions=$((executions + $(figure number_of_executed_units || true) + 0))
    inputs=$((inputs + $(figure new_units_added || true) + 0))
    [ "$(figure peak_rss_mb || true)" -le "$peak" ] 2>/dev/null || peak=$(figure peak_rss_mb)
    runs=$((runs + 1))
    left=$((seconds - (SECONDS - begin)))
  done
  rm -f "$log.one"
  local took=$((SECONDS - begin))
  [ "$took" -gt 0 ] || took=1
  printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$room/$name" "$took" "$executions" $((executions / took)) "$inputs" "${peak:-0}" \
    "$(find "$found" -type f | wc -l)" >"$results/$room.$name.tsv"
}
export -f run_target
export root
printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -L 1 bash -c 'set -u; run_target "$@"' run_target

sort "$results"/*.tsv | awk -F'\t' '
  BEGIN { printf "%-28s %8s %12s %9s %10s %8s %9s\n", "target", "seconds", "executions", "a second", "new inputs", "peak MB", "findings" }
  { printf "%-28s %8d %12d %9d %10d %8d %9d\n", $1, $2, $3, $4, $5, $6, $7; e += $3; s += $2; f += $7 }
  END { printf "%-28s %8d %12d %9s %10s %8s %9d\n", "all", s, e, "", "", "", f; exit f > 0 }'
