#!/usr/bin/env bash
# Lets simulated time go in every world below a folder, and tells which of them crash, take too long or leak.
#
#   scripts/trace_worlds.sh FOLDER [PROGRAM]
#
# PROGRAM is build/release/ghostspace unless it is given; with that of build/asan what its sanitizers report counts,
# too, leaks among it. UNTIL: seconds of simulated time [10]. LIMIT: seconds for one world [20]. A world that cannot be
# read (status 1) or has nothing to send is no fault here: scripts/sweep.sh looks after those.
# A line a fault, "WHAT WORLD", then a line of counts. Status 1 where there was a fault.
set -u
folder=${1:?usage: scripts/trace_worlds.sh FOLDER [PROGRAM]}
program=${2:-$(dirname "$0")/../build/release/ghostspace}
until=${UNTIL:-10} limit=${LIMIT:-20}
[ -d "$folder" ] || { echo "no folder $folder" >&2; exit 2; }
[ -x "$program" ] || { echo "no program $program" >&2; exit 2; }
messages=$(mktemp) || exit 2
trap 'rm -f "$messages"' EXIT

worlds=0 faults=0 refused=0 events=0
fault() { faults=$((faults + 1)); printf '%-8s %s\n' "$1" "$2"; }
while IFS= read -r -d '' world; do
  worlds=$((worlds + 1))
  # The events themselves are many: only their number is kept.
  lines=$(timeout -k 5 "$limit" "$program" trace "$world" --offline --until "$until" 2>"$messages" | wc -l; exit "${PIPESTATUS[0]}")
  status=$?
  events=$((events + lines))
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
done < <(find -L "$folder" -type f \( -iname '*.wrl' -o -iname '*.wrz' -o -iname '*.vrml' -o -iname '*.wrl.gz' \) -print0 | sort -z)
printf '%d worlds, %d events, %d faults, %d that could not be read\n' $worlds "$events" $faults $refused
[ $faults -eq 0 ]
