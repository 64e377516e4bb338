#!/usr/bin/env bash
# bench.sh [--quick] [--runs N]: writes the benchmark worlds to a cache folder and measures GhostSpace's parser with
# them. Also measures other programs if they are installed (PEERS_HOME, default ~/.cache/ghostspace-peers), in the same
# run. Prints Markdown tables; docs/benchmarks.md explains them. --quick leaves out measurements that take minutes.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
peers=${PEERS_HOME:-$HOME/.cache/ghostspace-peers}
shared=${GHOSTSPACE_SHARED:-$root/../shared}
cache=${XDG_CACHE_HOME:-$HOME/.cache}/ghostspace-bench

quick=no runs=5
while [ $# -gt 0 ]; do
  case $1 in
    --quick) quick=yes ;;
    --runs) runs=${2:?--runs needs a number}; shift ;;
    *) echo "usage: bench.sh [--quick] [--runs N]" >&2; exit 2 ;;
  esac
  shift
done

"$root/scripts/install-dependencies.sh" >&2
(cd "$root" && cmake --preset release >/dev/null && cmake --build --preset release --target ghostspace bench_inputs parse_bench) >&2
build=$root/build/release
ghostspace=$build/ghostspace

# Write the worlds again if the program that writes them has changed.
if [ ! "$cache/complete" -nt "$build/bench/bench_inputs" ]; then
  "$build/bench/bench_inputs" "$cache"
  touch "$cache/complete"
fi
# The same worlds in X3D.
x3d=("$cache/grid1m.x3d" "$cache/grid1m.x3dj")
for world in nodes20k proto5k routes10k; do
  for ending in x3d x3dj; do
    file=$cache/$world.$ending
    [ "$file" -nt "$cache/complete" ] || "$ghostspace" export "$cache/$world.wrl" "$file" >&2
    x3d+=("$file")
  done
done
worlds=(grid100k grid1m grid4m nodes20k proto5k routes10k)
files=("${worlds[@]/%/.wrl}")
files=("${files[@]/#/$cache/}")

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
now() { date +%s.%N; }

# Prints the median of the numbers on standard input, or - if there are none.
median() {
  sort -g | awk '{ v[NR] = $1 } END { if (!NR) print "-"; else if (NR % 2) print v[(NR + 1) / 2]; else print (v[NR / 2] + v[NR / 2 + 1]) / 2 }'
}
# Prints the elapsed seconds of a command. Prints nothing if it fails or takes longer than LIMIT seconds.
wall() {
  local start end
  start=$(now)
  { timeout -k 2 "${LIMIT:-120}" "$@" >"$scratch/out" 2>&1 </dev/null; } 2>/dev/null || return 0
  end=$(now)
  awk -v a="$start" -v b="$end" 'BEGIN { printf "%.3f\n", b - a }'
}

# The parse_ functions print the seconds that a program needs to parse FILE, or nothing.
parse_ghostspace() {
  timeout -k 2 120 "$ghostspace" check --stats "$scratch/check.json" "$1" >/dev/null 2>&1 || true
  grep -oE '"parse_s": *[0-9.e+-]+' "$scratch/check.json" 2>/dev/null | sed 's/.*: *//'
  rm -f "$scratch/check.json"
}
parse_coin() { timeout -k 2 120 "$peers/bin/coin-tool" "$1" 2>/dev/null | grep -oE 'readAll [0-9.]+' | cut -d' ' -f2; }
parse_vtk() { wall "$peers/bin/vtk-tool" "$1"; }
parse_three_node() {
  PEERS_HOME=$peers timeout -k 2 120 node --max-old-space-size=12000 "$shared/peers/tools/three-node.mjs" "$1" 2>/dev/null |
    grep 'ok=true' | grep -oE 'parse [0-9.]+' | cut -d' ' -f2
}
# The picture_ functions print the seconds from the start of a program to its picture in a file, 1024x768.
picture_ghostspace() { wall "$ghostspace" --snapshot "$scratch/picture.png" --samples 1 --timeout 120 "$1"; }
picture_coin() { wall with_display "$peers/bin/coin-tool" "$1" "$scratch/picture.png"; }
picture_vtk() { wall with_display "$peers/bin/vtk-tool" "$1" "$scratch/picture.png"; }
picture_view3dscene() {
  wall with_display view3dscene --hide-extras --no-sound --geometry 1024x768+0+0 --screenshot 0 "$scratch/picture.png" "$1"
}
# `timeout` can only run a program, not a function. This program sets the display.
cat >"$scratch/with_display" <<'END'
#!/bin/sh
DISPLAY=$BENCH_DISPLAY LIBGL_ALWAYS_SOFTWARE=1 exec "$@"
END
chmod +x "$scratch/with_display"
PATH=$scratch:$PATH

parsers=(ghostspace) painters=(ghostspace)
if [ -x "$peers/bin/coin-tool" ]; then parsers+=(coin); painters+=(coin); fi
if [ -x "$peers/bin/vtk-tool" ]; then parsers+=(vtk); painters+=(vtk); fi
if [ -d "$peers/npm/node_modules/three" ] && [ -f "$shared/peers/tools/three-node.mjs" ] && command -v node >/dev/null; then
  parsers+=(three_node)
fi
if [ -d "$peers" ] && command -v view3dscene >/dev/null; then painters+=(view3dscene); fi

# Returns true for pairs of program and world that take minutes or gigabytes. They are left out.
too_slow() {
  case $1-$2 in
    three_node-grid4m | view3dscene-grid4m | view3dscene-nodes20k | view3dscene-proto5k | vtk-nodes20k) return 0 ;;
    three_node-grid1m | view3dscene-grid1m) [ "$quick" = yes ] ;;
    *) return 1 ;;
  esac
}

# table WHAT CONTENDER...: prints medians of interleaved runs, one row per world.
table() {
  local what=$1 world contender run cells
  shift
  printf '| s | %s |\n| --- |%s\n' "$(printf '%s | ' "$@" | sed 's/ | $//; s/_/-/g')" "$(printf ' --: |%.0s' "$@")"
  for world in "${worlds[@]}"; do
    rm -f "$scratch"/times.*
    for ((run = 0; run < runs; ++run)); do
      for contender in "$@"; do
        too_slow "$contender" "$world" || "${what}_$contender" "$cache/$world.wrl" >>"$scratch/times.$contender" || true
      done
    done
    cells=
    for contender in "$@"; do
      if [ -e "$scratch/times.$contender" ]; then cells+=" $(median <"$scratch/times.$contender") |"; else cells+=" not run |"; fi
    done
    printf '| %s |%s\n' "$world" "$cells"
  done
}

processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)
echo "$(nproc) x ${processor:-unknown processor}, $(g++ --version | head -1), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown), $(date -u +%F)"
echo
echo "## The parser beside the bare loop, median of $runs"
echo
"$build/bench/parse_bench" --markdown --runs "$runs" "${files[@]}" "${x3d[@]}"
echo
if [ ${#painters[@]} -gt 1 ] && command -v Xvfb >/dev/null; then
  # Xvfb chooses a free display number and writes it to a file.
  Xvfb -displayfd 3 -screen 0 1280x1024x24 +extension GLX -nolisten tcp 3>"$scratch/display" >/dev/null 2>&1 &
  display_server=$!
  trap 'kill "$display_server" 2>/dev/null || true; rm -rf "$scratch"' EXIT
  for ((i = 0; i < 50; ++i)); do [ -s "$scratch/display" ] && break; sleep 0.1; done
  BENCH_DISPLAY=:$(cat "$scratch/display")
  export BENCH_DISPLAY
else
  painters=(ghostspace)
fi
echo "## Seconds to parse, median of $runs (- fails)"
echo
table parse "${parsers[@]}"
echo
echo "## Seconds from the start of the program to its picture in a file, 1024x768, median of $runs (- fails)"
echo
table picture "${painters[@]}"
