#!/usr/bin/env bash
# bench_transfer.sh [--quick] [--model FILE] [OPTION...]: measures bench/transfer on emulated links and prints Markdown
# tables. docs/benchmarks.md explains them. A full run takes about twenty minutes; --quick measures one link with and
# without loss. Other options go to bench/transfer, which lists its options if one is wrong. Needs root, or `unshare -r`
# if permitted. Has no effect outside of its network namespaces.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
shared=${GHOSTSPACE_SHARED:-$root/../shared}
cache=${XDG_CACHE_HOME:-$HOME/.cache}/ghostspace-bench

model=$shared/data/meshes/scans/armadillo.obj
archive=$cache/lod_65_million.qnv
arguments=()
while [ $# -gt 0 ]; do
  case $1 in
    --quick) arguments+=(--rates 10 --rtts 20 --losses 0,10) ;;
    --model) model=${2:?--model needs a file}; shift ;;
    *) arguments+=("$1") ;;
  esac
  shift
done

"$root/scripts/install-dependencies.sh" >&2
(cd "$root" && cmake --preset release >/dev/null && cmake --build --preset release --target ghostspace transfer lod_bench) >&2
build=$root/build/release

# Make a packed stream of 50 MB once. This takes a minute and 13 GB of memory.
if [ ! -e "$archive" ]; then
  if [ "$(awk '/^MemAvailable/ { print int($2 / 1e6) }' /proc/meminfo)" -ge 15 ]; then
    "$build/bench/lod_bench" --vectors 65 --frames 1 --folder "$cache" >/dev/null
  else
    echo "bench_transfer.sh: not enough memory for a stream of 50 MB; its table is left out" >&2
  fi
fi
[ -e "$archive" ] && arguments+=(--archive "$archive")

alone=()
[ "$(id -u)" -eq 0 ] || alone=(unshare -r)
processor=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1)
echo "$(nproc) x ${processor:-unknown processor}, Linux $(uname -r), commit $(git -C "$root" rev-parse --short HEAD 2>/dev/null || echo unknown), $(date -u +%F)"
echo
exec "${alone[@]}" "$build/bench/transfer" --model "$model" "${arguments[@]}"
