#!/usr/bin/env bash
# Advances simulated time in all worlds below a folder. Reports worlds that crash, take too long or leak.
#
#   scripts/trace_worlds.sh [--play] FOLDER [PROGRAM]
#
# --play: only worlds with Scripts. Presses, drags and releases each pointing-device sensor and Anchor, and goes to each
# ProximitySensor (trace --press-sensors).
# PROGRAM: default build/release/ghostspace. With the program of build/asan, sanitizer reports and leaks count, too.
# UNTIL: seconds of simulated time [10, with --play 20]. LIMIT: seconds per world [20, with --play 120].
# MESSAGES: file for the messages of each world, "WORLD<tab>MESSAGE".
#
# Ignores worlds that cannot be read (status 1) or have nothing to send; scripts/sweep.sh checks them. Prints one line
# per fault, "WHAT WORLD", then a line of counts. Exits with 1 if there was a fault.
set -u
play=0
[ "${1:-}" = --play ] && { play=1; shift; }
folder=${1:?usage: scripts/trace_worlds.sh [--play] FOLDER [PROGRAM]}
program=${2:-$(dirname "$0")/../build/release/ghostspace}
options=(--offline)
if [ $play = 1 ]; then
  until=${UNTIL:-20} limit=${LIMIT:-120}
  options+=(--press-sensors)
else
  until=${UNTIL:-10} limit=${LIMIT:-20}
fi
[ -d "$folder" ] || { echo "no folder $folder" >&2; exit 2; }
[ -x "$program" ] || { echo "no program $program" >&2; exit 2; }
messages=$(mktemp) || exit 2
trap 'rm -f "$messages"' EXIT
[ -z "${MESSAGES:-}" ] || : >"$MESSAGES"

all_worlds() {
  find -L "$folder" -type f \( -iname '*.wrl' -o -iname '*.wrz' -o -iname '*.vrml' -o -iname '*.wrl.gz' \) -print0
}
# Prints the worlds with Scripts, compressed by gzip or not, whatever their names.
scripted_worlds() {
  local pattern='(^|[^A-Za-z0-9_])Script[[:space:]]*(\{|$)'
  all_worlds | xargs -0 -r grep -lZaE "$pattern"
  while IFS= read -r -d '' world; do
    gzip -dc <"$world" 2>/dev/null | grep -qaE "$pattern" && printf '%s\0' "$world"
  done < <(all_worlds | LC_ALL=C xargs -0 -r grep -lZaP '\A\x1f\x8b')
}
worlds_to_trace() { if [ $play = 1 ]; then scripted_worlds; else all_worlds; fi | sort -zu; }

worlds=0 faults=0 refused=0 events=0 sensors=0 pressed=0
fault() { faults=$((faults + 1)); printf '%-8s %s\n' "$1" "$2"; }
while IFS= read -r -d '' world; do
  worlds=$((worlds + 1))
  # There are many events, so keep only their number.
  lines=$(timeout -k 5 "$limit" "$program" trace "$world" "${options[@]}" --until "$until" 2>"$messages" | wc -l; exit "${PIPESTATUS[0]}")
  status=$?
  events=$((events + lines))
  if [ $play = 1 ]; then
    read -r one all < <(sed -n 's/.*note: \([0-9]*\) of \([0-9]*\) sensors and Anchors pressed.*/\1 \2/p' "$messages" | tail -1)
    pressed=$((pressed + ${one:-0})) sensors=$((sensors + ${all:-0}))
  fi
  [ -z "${MESSAGES:-}" ] || sed "s|^|$world\t|" "$messages" >>"$MESSAGES"
  if grep -q 'LeakSanitizer: detected' "$messages"; then
    fault leak "$world"
  elif grep -qE 'Sanitizer|runtime error:' "$messages"; then
    fault report "$world"
  elif [ $status -eq 124 ] || [ $status -eq 137 ]; then
    fault timeout "$world"
  elif [ $status -ge 128 ]; then
    fault crash "$world"
  elif [ $status -ne 0 ]; then
    refused=$((refused + 1))
  fi
done < <(worlds_to_trace)
printf '%d worlds, %d events, %d faults, %d that could not be read\n' $worlds "$events" $faults $refused
[ $play = 0 ] || printf '%d of %d sensors and Anchors pressed\n' $pressed $sensors
[ $faults -eq 0 ]
