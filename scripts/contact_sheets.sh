#!/usr/bin/env bash
# contact_sheets.sh DATA [OUT]: draws the pictures in docs/images that show how streams are refined. DATA contains
# meshes/scans, meshes/odedstein and volumes/cthead (docs/benchmarks.md).
set -euo pipefail
cd "$(dirname "$0")/.."
data=${1:?the folder with the test data}
out=${2:-docs/images}
ghostspace=build/release/ghostspace
sheet=build/release/bench/contact_sheet
cmake --preset release >/dev/null
cmake --build --preset release --target ghostspace contact_sheet >/dev/null
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

pictures=()
for model in scans/bun_zipper.ply odedstein/koala.obj scans/armadillo.obj; do
  "$ghostspace" encode "$data/meshes/$model" "$work/model.qnv" >/dev/null
  for part in 1000 2000 8000 $(stat -c %s "$work/model.qnv"); do
    picture=$work/$(basename "$model").$part.png
    "$ghostspace" --snapshot "$picture" --size 320x240 --orbit 35,10 --background 0.1,0.1,0.12 --max-bytes $part "$work/model.qnv"
    pictures+=("$picture")
  done
done
"$sheet" 4 "$out/prefixes.png" "${pictures[@]}"

# The scan lies on its back: the face looks to -y, and the top of the head is at -z.
cat > "$work/head.wrl" <<'WORLD'
#VRML V2.0 utf8
Transform {
  rotation 0 0.70711 -0.70711 3.14159
  children Shape { appearance Appearance { material Material { } } geometry QNV { url "head.qnv" profile "VOLUME" } }
}
WORLD
pictures=()
"$ghostspace" encode "$data/volumes/cthead/CThead.nhdr" "$work/whole.qnv" >/dev/null
for bytes in 4000 15000 60000 100000000; do
  head -c $bytes "$work/whole.qnv" >"$work/head.qnv"
  "$ghostspace" --snapshot "$work/head.$bytes.png" --size 400x400 --orbit 40,10 --background 0,0,0 "$work/head.wrl"
  pictures+=("$work/head.$bytes.png")
done
"$sheet" 4 "$out/cthead.png" "${pictures[@]}"
