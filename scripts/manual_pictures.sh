#!/usr/bin/env bash
# manual_pictures.sh [NAME...]: makes the pictures of docs/manual.md, docs/images/manual/NAME.png (default: all), and
# its table of keys, with the present program. The worlds are in assets/; a volume is computed here. So a clean checkout
# is sufficient. Windows run under Xvfb. xdotool controls them, and ImageMagick's import takes the pictures. GHOSTSPACE:
# program instead of build/release/ghostspace. OUT: other folder for the pictures.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
ghostspace=${GHOSTSPACE:-$root/build/release/ghostspace}
worlds=$root/assets/worlds
out=${OUT:-$root/docs/images/manual}
missing=()
for tool in Xvfb xdotool import convert awk; do command -v $tool >/dev/null || missing+=("$tool"); done
if [ ${#missing[@]} -gt 0 ]; then
  echo "manual_pictures.sh: ${missing[*]} missing (Debian: xvfb, xdotool, imagemagick)" >&2
  exit 2
fi
[ -x "$ghostspace" ] || { echo "manual_pictures.sh: $ghostspace is missing; build it first (scripts/run.sh)" >&2; exit 2; }

work=$(mktemp -d /tmp/ghostspace-manual.XXXXXX)
mkdir -p "$out" "$work"/{home,runtime}
chmod 700 "$work/runtime"
display='' window='' server=''
leave() {
  for process in $window $server $display; do kill "$process" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$work"
}
trap leave EXIT
# Use an empty user folder, and no desktop that would open its own dialogs.
export HOME=$work/home XDG_RUNTIME_DIR=$work/runtime XDG_CONFIG_HOME=$work/home/.config XDG_STATE_HOME=$work/home/.state
export XDG_CACHE_HOME=$work/home/.cache
unset DBUS_SESSION_BUS_ADDRESS WAYLAND_DISPLAY XDG_CURRENT_DESKTOP
cd "$work"
cp "$worlds"/*.wrl "$worlds"/*.qnv .

# Compute a molecule of twelve atoms in a ring, as a density of 64 x 64 x 64 voxels.
awk 'BEGIN {
  print "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 64 64 64\nspacings: 0.25 0.25 0.25\nencoding: ascii\n"
  for (k = 0; k < 6; k++) { a = k * 1.0471975512; s = sin(a); c = cos(a)
    x0[k] = 3.6 * c; y0[k] = 3.6 * s; x0[k + 6] = 6 * c; y0[k + 6] = 6 * s }
  for (z = 0; z < 64; z++) for (y = 0; y < 64; y++) { line = ""
    for (x = 0; x < 64; x++) { X = (x - 31.5) / 4; Y = (y - 31.5) / 4; Z = (z - 31.5) / 4; value = 0
      for (k = 0; k < 12; k++) { d = (X - x0[k])^2 + (Y - y0[k])^2 + Z * Z
        if (d < 9) value += (k < 6 ? 230 * exp(-0.9 * d) : 120 * exp(-1.4 * d)) }
      r = sqrt(X * X + Y * Y) - 3.6; value += 70 * exp(-0.6 * (r * r + Z * Z))
      line = line int(value > 255 ? 255 : value) " " }
    print line } }' >molecule.nrrd

small() { convert "$1" -dither FloydSteinberg -colors 256 -strip PNG8:"$out/$2.png"; }
# draw OUT [OPTION...]: makes a picture without a window.
draw() { "$ghostspace" --snapshot "$1" --backend osmesa "${@:2}"; }

# show WIDTHxHEIGHT [ARGUMENT...]: opens a window, and waits until it no longer changes.
show() {
  if [ -z "$display" ]; then
    exec 9<>"$work/number"
    Xvfb -displayfd 9 -screen 0 1280x800x24 >/dev/null 2>&1 &
    display=$!
    for _ in $(seq 100); do [ -s "$work/number" ] && break; sleep 0.1; done
    DISPLAY=:$(tr -d ' \n' <"$work/number")
    export DISPLAY
  fi
  size=$1
  "$ghostspace" --mute --size "$size" "${@:2}" 2>"$work/window.log" &
  window=$!
  for _ in $(seq 200); do xdotool search --name '.' >/dev/null 2>&1 && break; sleep 0.2; done
  xdotool mousemove 400 300
  rest
}
shot() { import -window root -crop "$size+0+0" +repage "$work/$1"; }
# Waits until nothing moves, at most 20 seconds. A world that always moves gets all of them.
rest() {
  local before=''
  for _ in $(seq "${1:-14}"); do
    sleep 1
    shot now.png
    now=$(convert now.png rgb:- | md5sum)
    [ "$now" = "$before" ] && return
    before=$now
  done
}
key() { for each in "$@"; do xdotool key "$each"; sleep 0.6; done; rest 6; }
click() { xdotool mousemove "$1" "$2"; sleep 0.4; xdotool click "${3:-1}"; rest 6; }
drag() {
  xdotool mousemove "$1" "$2" mousedown 1
  for part in 1 2 3 4; do sleep 0.2; xdotool mousemove $(($1 + ($3 - $1) * part / 4)) $(($2 + ($4 - $2) * part / 4)); done
  sleep 0.3
  xdotool mouseup 1
  rest 6
}
# take NAME: saves the content of the window, and closes the window.
take() {
  shot taken.png
  small "$work/taken.png" "$1"
  kill $window
  wait $window 2>/dev/null || true
  window=''
  rm -rf "$XDG_STATE_HOME"
}

picture_window() {
  show 900x560 demo.wrl
  click 71 13 # View menu
  take window
}

picture_palette() {
  show 900x560 demo.wrl
  key ctrl+shift+p
  xdotool type --delay 80 'view'
  rest 4
  take palette
}

picture_viewports() {
  show 1000x560 --layout '1:2|(2/3)' demo.wrl molecule.nrrd missing.wrl
  click 710 77 3 # menu of the second viewport
  take viewports
}

picture_transfer() {
  show 900x560 molecule.nrrd
  key F4
  take transfer
}

picture_inspect() {
  show 1000x600 demo.wrl
  key ctrl+shift+t ctrl+shift+i
  click 60 108 # field that filters names
  xdotool type --delay 120 Boat
  key Return
  xdotool mousemove 440 520
  rest 3
  take inspect
}

# Shows a stream that is received slowly.
picture_streams() {
  mkdir -p served
  "$ghostspace" encode --isovalue 40 --vectors 60000 molecule.nrrd served/molecule.qnv >/dev/null
  "$ghostspace" serve served --http 0 --rate 2500 --log /dev/null >server.log 2>&1 &
  server=$!
  local address=''
  for _ in $(seq 50); do
    address=$(grep -oE 'http://[^ /]+' server.log | head -1) && break
    sleep 0.2
  done
  show 1000x560 "$address/molecule.qnv"
  key ctrl+shift+e
  click 200 470 # row of the stream, which opens a plot
  xdotool mousemove 200 300
  sleep 2
  take streams
  kill $server
  wait $server 2>/dev/null || true
  server=''
}

picture_measure() {
  show 1000x600 molecule.nrrd
  key v
  click 725 201 # planes across X and Z, and the colour bar
  click 725 260
  click 723 173
  drag 250 420 330 360
  xdotool mousemove 300 250
  rest 4
  take measure
}

picture_splats-panel() {
  show 1000x600 demo-bonsai.qnv
  key ctrl+shift+g
  click 740 135 # add a crop box
  drag 846 380 875 380 # exposure
  xdotool mousemove 300 560
  rest 4
  take splats-panel
}

picture_prefixes() {
  "$ghostspace" encode --isovalue 40 --vectors 30000 molecule.nrrd surface.qnv >/dev/null
  local look=(--size 220x200 --orbit 20,40 --headlight on --background 0.16,0.18,0.22)
  for bytes in 1200 3k 8k; do draw part.$bytes.png "${look[@]}" --max-bytes $bytes surface.qnv; done
  draw part.all.png "${look[@]}" surface.qnv
  draw part.lost.png "${look[@]}" --loss 0.1 surface.qnv
  convert part.1200.png part.3k.png part.8k.png part.all.png part.lost.png +append parts.png
  small parts.png prefixes
}

# Writes the table of keys, from the program's table of actions, between two marks of the manual.
keys() {
  "$ghostspace" man | awk '
    /^\.SH/ { inside = ($2 == "KEYS"); next }
    inside && /^\.B / { key = substr($0, 4); gsub(/\\&|\\/, "", key); next }
    inside && key != "" && !/^\./ { sub(/\.$/, ""); gsub(/\\&|\\/, ""); printf "| %s | %s |\n", key, $0; key = "" }' >rows
  [ -s rows ] || { echo "manual_pictures.sh: ghostspace man has no KEYS" >&2; exit 1; }
  awk -v rows=rows '
    /<!-- keys: end/ { inside = 0 }
    !inside { print }
    /<!-- keys: begin/ { inside = 1; print "| Key | |\n| --- | --- |"; while ((getline line < rows) > 0) print line }' \
    "$root/docs/manual.md" >manual.md
  cat manual.md >"$root/docs/manual.md"
}

names=("$@")
[ ${#names[@]} -gt 0 ] || names=(window palette viewports inspect streams transfer measure prefixes keys)
for name in "${names[@]}"; do
  if [ "$name" = keys ]; then keys; else picture_$name; fi
  echo "$name"
done
