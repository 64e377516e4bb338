#!/usr/bin/env bash
# fuzz.sh [SECONDS]: builds the libFuzzer targets with clang and runs each for SECONDS (60), starting from the test corpora
# and the dictionary of the node table. What it finds is kept in build/fuzz/findings and makes the script fail; move it to
# tests/fuzz/corpus (or corpus_qnv, corpus_cells) under a name that says what it is.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
seconds=${1:-60}
command -v clang++ >/dev/null || { echo "fuzz.sh: clang++ is missing: install the Debian packages clang and libclang-rt-14-dev" >&2; exit 2; }
cd "$root"
"$root/scripts/install-dependencies.sh"
cmake --preset fuzz >/dev/null
cmake --build --preset fuzz --target ghostspace vrml_parse_fuzz qnv_stream_fuzz cell_datagram_fuzz

work=$root/build/fuzz/work
findings=$root/build/fuzz/findings
mkdir -p "$work" "$work-qnv" "$work-cells" "$findings"
# Every name of the node table, and the keywords of Annex A.
{
  "$root/build/fuzz/ghostspace" nodes --wrl | grep -oE '[A-Za-z][A-Za-z0-9_]+' | sort -u
  printf '%s\n' DEF USE ROUTE TO PROTO EXTERNPROTO IS NULL TRUE FALSE
} | sed 's/.*/"&"/' >"$work.dict"
"$root/build/fuzz/tests/vrml_parse_fuzz" "$work" "$root/tests/vrml/good" "$root/tests/vrml/bad" "$root/tests/fuzz/corpus" \
  -dict="$work.dict" -artifact_prefix="$findings/" -max_total_time="$seconds" -max_len=8192 -timeout=10 -rss_limit_mb=2048
"$root/build/fuzz/tests/qnv_stream_fuzz" "$work-qnv" "$root/tests/fuzz/corpus_qnv" \
  -artifact_prefix="$findings/" -max_total_time="$seconds" -max_len=16384 -timeout=10 -rss_limit_mb=2048
"$root/build/fuzz/tests/cell_datagram_fuzz" "$work-cells" "$root/tests/fuzz/corpus_cells" \
  -artifact_prefix="$findings/" -max_total_time="$seconds" -max_len=16384 -timeout=10 -rss_limit_mb=2048
