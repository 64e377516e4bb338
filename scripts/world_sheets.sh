#!/usr/bin/env bash
# world_sheets.sh DIR [OUT]: draws all VRML files below DIR as small pictures. Puts the pictures with their names on
# sheets for viewing, OUT/sheet-NN.png (default OUT: build/world_sheets). A sheet is itself a world. A failed file
# leaves a white square. PART=3/10 takes the third tenth of the files.
set -euo pipefail

script=$(readlink -f "${BASH_SOURCE[0]}")
root=$(cd "$(dirname "$script")/.." && pwd)
ghostspace=${GHOSTSPACE:-$root/build/release/ghostspace}
[ $# -ge 1 ] || { echo "usage: world_sheets.sh DIR [OUT]" >&2; exit 2; }
worlds=$(readlink -f "$1")
out=$(mkdir -p "${2:-$root/build/world_sheets}" && readlink -f "${2:-$root/build/world_sheets}")
part=${PART:-1/1}
columns=8 rows=6 width=192 height=144

mapfile -t files < <(find -L "$worlds" -type f \( -iname '*.wrl' -o -iname '*.wrz' -o -iname '*.wrl.gz' \) | LC_ALL=C sort)
count=${#files[@]}
first=$((count * (${part%/*} - 1) / ${part#*/})) end=$((count * ${part%/*} / ${part#*/}))

# Prints the name as a VRML string. Quotes, backslashes and special characters become full stops.
name_of() {
  local name=${1#"$worlds"/}
  [ ${#name} -le 34 ] || name="..${name: -32}"
  printf '%s' "$name" | LC_ALL=C sed 's/[^ -~]/./g; s/["\\]/./g'
}

for ((begin = first; begin < end; begin += columns * rows)); do
  number=$(printf '%02d' $((begin / (columns * rows))))
  folder=$out/$number
  mkdir -p "$folder"
  sheet=$folder/sheet.wrl
  {
    echo '#VRML V2.0 utf8'
    echo 'NavigationInfo { headlight FALSE } Background { skyColor 0.25 0.25 0.25 }'
    # 2 * atan(half the height / distance), with rows of height 1.2.
    echo "Viewpoint { position $(awk "BEGIN { print $columns * 0.7, -$rows * 0.6 - 0.02 }") 40 fieldOfView $(awk "BEGIN { print 2 * atan2($rows * 0.61, 40) }") }"
    echo 'PROTO Picture [ field SFVec3f at 0 0 0 field MFString url [] field MFString name [] ] {'
    echo '  Transform { translation IS at children ['
    echo '    Shape { appearance Appearance { texture ImageTexture { url IS url } } geometry IndexedFaceSet { coord Coordinate { point [ 0.02 0 0, 1.355 0 0, 1.355 1 0, 0.02 1 0 ] } coordIndex [ 0 1 2 3 ] texCoord TextureCoordinate { point [ 0 0, 1 0, 1 1, 0 1 ] } } }'
    echo '    Transform { translation 0 -0.1 0 children Shape { geometry Text { string IS name maxExtent 1.33 fontStyle FontStyle { size 0.09 family "SANS" } } } }'
    echo '  ] }'
    echo '}'
    for ((i = begin; i < begin + columns * rows && i < end; ++i)); do
      place=$((i - begin))
      picture=$folder/$place.png
      rm -f "$picture"
      timeout 60 "$ghostspace" --offline --allow "$worlds" --backend osmesa --size "${width}x$height" --timeout 20 --snapshot "$picture" "${files[i]}" \
        >"$folder/$place.txt" 2>&1 || true
      x=$(awk "BEGIN { print ($place % $columns) * 1.4 }") y=$(awk "BEGIN { print -int($place / $columns) * 1.2 - 1.05 }")
      echo "Picture { at $x $y 0 url \"$([ -s "$picture" ] && echo "$place.png")\" name \"$place $(name_of "${files[i]}")\" }"
    done
  } >"$sheet"
  "$ghostspace" --backend osmesa --size "$((columns * (width + 10)))x$((rows * (height + 30)))" --snapshot "$out/sheet-$number.png" "$sheet" || true
done
