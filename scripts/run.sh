#!/usr/bin/env bash
# run.sh [FILE...]: installs missing packages, builds GhostSpace and opens the files, or the demo world. Without a
# display, draws pictures into the current folder instead.
set -euo pipefail

for file in "$@"; do
  case $file in
    -*) echo "run.sh: $file is an option; expected files only (build/release/ghostspace --help lists options)" >&2
        exit 2 ;;
  esac
done
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-dependencies.sh"
(cd "$root" && cmake --preset release >/dev/null && cmake --build --preset release --target ghostspace)
ghostspace=$root/build/release/ghostspace

demo=$root/assets/worlds/demo.wrl
[ $# -gt 0 ] || set -- "$demo"

if [ -n "${DISPLAY:-}" ] || [ -n "${WAYLAND_DISPLAY:-}" ]; then
  exec "$ghostspace" "$@"
fi

# Prints an unused file name: NAME.png, NAME-2.png, ...
free_name() {
  local candidate=$1.png number=2
  while [ -e "$candidate" ] || [ -L "$candidate" ]; do
    candidate=$1-$number.png
    number=$((number + 1))
  done
  printf '%s' "$candidate"
}

echo "There is no display: drawing pictures instead."
status=0
for file in "$@"; do
  stem=$(basename "$file")
  picture=$(free_name "$PWD/ghostspace-${stem%%.*}")
  if "$ghostspace" --snapshot "$picture" "$file"; then
    echo "$file: see $picture"
  else
    echo "$file: no picture could be drawn" >&2
    status=1
  fi
done
exit $status
