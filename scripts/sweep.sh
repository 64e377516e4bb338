#!/usr/bin/env bash
# sweep.sh DIR [--asan]: opens all VRML files below DIR with `ghostspace check` and `ghostspace --snapshot`, and reports
# the results. Writes one row per file to build/sweep/files.tsv; pictures and error messages are in the same folder.
# Prints a table by top-level folder. Exits with 1 after any crash, hang or sanitizer report.
set -euo pipefail

script=$(readlink -f "${BASH_SOURCE[0]}")
root=$(cd "$(dirname "$script")/.." && pwd)

usage() {
  echo "usage: sweep.sh DIR [--asan]" >&2
  exit 2
}

# Prints the result for an exit status and the messages on standard error: ok, refused, crash, hang, sanitizer or usage.
outcome() {
  local status=$1 messages=$2
  if grep -qE 'ERROR: (Address|Leak|Thread)Sanitizer|: runtime error: |SUMMARY: [A-Za-z]*Sanitizer' "$messages"; then
    echo sanitizer
  elif [ "$status" -eq 0 ]; then
    echo ok
  elif [ "$status" -eq 1 ]; then
    echo refused
  elif [ "$status" -eq 124 ] || [ "$status" -eq 137 ]; then
    echo hang # ended by timeout
  elif [ "$status" -gt 128 ]; then
    echo crash
  else
    echo "exit-$status"
  fi
}

# Prints the number for a key in a stats file, or - if it is missing.
stat_of() {
  local value
  value=$(grep -oE "\"$2\": *-?[0-9.e+-]+" "$1" 2>/dev/null | head -1 | sed 's/.*: *//')
  printf '%s' "${value:--}"
}

sweep_one() {
  local file=$1 relative=${1#"$SWEEP_DIR"/} collection scratch check picture check_status=0 picture_status=0 key
  case $relative in */*) collection=${relative%%/*} ;; *) collection=. ;; esac
  scratch=$(mktemp -d)
  # worlds share textures with neighbouring folders
  local allowed=$SWEEP_DIR
  [ "$collection" = . ] || allowed=$SWEEP_DIR/$collection
  key=$(printf '%s' "$relative" | tr -c 'A-Za-z0-9._\n-' '_')
  local image=$SWEEP_OUT/pictures/$key.png
  ulimit -c 0
  [ "$SWEEP_ASAN" = yes ] || ulimit -v $((8 * 1024 * 1024))

  # the braces redirect bash's own message about a crash to the file, too
  { timeout -k 2 "$SWEEP_LIMIT" "$SWEEP_BINARY" check --allow "$allowed" --stats "$scratch/check.json" "$file" \
    >"$scratch/check.out" </dev/null || check_status=$?; } 2>"$scratch/check.err"
  check=$(outcome "$check_status" "$scratch/check.err")
  [ "$check" != refused ] || check=errors
  { timeout -k 2 "$SWEEP_LIMIT" "$SWEEP_BINARY" --snapshot "$image" --size 256x192 --samples 1 --timeout 10 \
    --allow "$allowed" --stats "$scratch/picture.json" "$file" >"$scratch/picture.out" </dev/null ||
    picture_status=$?; } 2>"$scratch/picture.err"
  picture=$(outcome "$picture_status" "$scratch/picture.err")
  local colors
  colors=$(stat_of "$scratch/picture.json" colors)
  if [ "$picture" = ok ] && [ "$colors" = 1 ]; then picture=blank; fi

  local log
  for log in check:"$check" picture:"$picture"; do
    case ${log#*:} in
      crash | hang | sanitizer | exit-*)
        cat "$scratch/${log%%:*}.out" "$scratch/${log%%:*}.err" | head -c 100000 >"$SWEEP_OUT/logs/$key.${log%%:*}.txt" ;;
    esac
  done
  local message=
  if [ "$check" != ok ] || [ "$picture" = refused ]; then
    message=$(cat "$scratch"/check.out "$scratch"/check.err "$scratch"/picture.err |
      { grep -m 1 -aE 'error:|Error|ERROR' || true; } | tr '\t' ' ' | cut -c1-300) || true # cat may find its reader gone
  fi
  # write each row at once, so that rows of two processes do not mix
  printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$collection" "$relative" "$check" "$picture" "$colors" \
    "$(stat_of "$scratch/picture.json" errors)" "$(stat_of "$scratch/picture.json" warnings)" \
    "$(stat_of "$scratch/picture.json" load_s)" "${message#"$SWEEP_DIR"/}" >>"$SWEEP_OUT/files.tsv"
  rm -rf "$scratch"
}

if [ "${1:-}" = --one ]; then
  shift
  sweep_one "$1"
  exit 0
fi

directory=
export SWEEP_ASAN=no SWEEP_LIMIT=20
preset=release
for argument in "$@"; do
  case $argument in
    --asan) SWEEP_ASAN=yes preset=asan SWEEP_LIMIT=60 ;;
    -*) usage ;;
    *) [ -z "$directory" ] || usage; directory=$argument ;;
  esac
done
[ -n "$directory" ] || usage
[ -d "$directory" ] || { echo "sweep.sh: $directory is no folder" >&2; exit 2; }

SWEEP_DIR=$(readlink -f "$directory")
SWEEP_BINARY=$root/build/$preset/ghostspace
SWEEP_OUT=$root/build/sweep
[ -x "$SWEEP_BINARY" ] || {
  echo "sweep.sh: build first: cmake --preset $preset && cmake --build --preset $preset" >&2
  exit 2
}
# Use a special exit status, so that a sanitizer report does not count as a refusal. The unit tests check for leaks:
# LeakSanitizer sometimes crashes after a program has drawn, while the threads of the software rasterizer end.
export ASAN_OPTIONS=exitcode=99:detect_leaks=0:allocator_may_return_null=0 UBSAN_OPTIONS=print_stacktrace=1:exitcode=99
export SWEEP_DIR SWEEP_BINARY SWEEP_OUT
rm -rf "$SWEEP_OUT"
mkdir -p "$SWEEP_OUT/pictures" "$SWEEP_OUT/logs"
: >"$SWEEP_OUT/files.tsv"

find -L "$SWEEP_DIR" -type f \( -iname '*.wrl' -o -iname '*.wrz' -o -iname '*.wrl.gz' \) -print0 | sort -z |
  xargs -0 -r -P 2 -n 1 "$script" --one

sort -o "$SWEEP_OUT/files.tsv" "$SWEEP_OUT/files.tsv"
sed -i '1i collection\tfile\tcheck\tpicture\tcolors\terrors\twarnings\tload_s\tmessage' "$SWEEP_OUT/files.tsv"

awk -F '\t' '
  NR == 1 { next }
  {
    if (!($1 in files)) names[++count] = $1
    files[$1]++
    outcome["check", $1, $3]++
    outcome["picture", $1, $4]++
    for (i = 3; i <= 4; ++i) if ($i == "crash" || $i == "hang" || $i == "sanitizer" || $i ~ /^exit-/) bad[$1, $i ~ /^exit-/ ? "crash" : $i]++
  }
  function row(name, label,    line, i) {
    line = sprintf("| %s | %d | %d | %d | %d | %d | %d | %d | %d | %d |", label, files[name], outcome["check", name, "ok"],
      outcome["check", name, "errors"], outcome["picture", name, "ok"], outcome["picture", name, "blank"],
      outcome["picture", name, "refused"], bad[name, "crash"], bad[name, "hang"], bad[name, "sanitizer"])
    print line
  }
  END {
    print "| collection | files | no errors | with errors | drawn | blank | refused | crashes | hangs | sanitizer |"
    print "| --- | --: | --: | --: | --: | --: | --: | --: | --: | --: |"
    for (n = 1; n <= count; ++n) {
      row(names[n], names[n])
      files[""] += files[names[n]]
      split("ok errors", checks, " "); for (i in checks) outcome["check", "", checks[i]] += outcome["check", names[n], checks[i]]
      split("ok blank refused", pictures, " "); for (i in pictures) outcome["picture", "", pictures[i]] += outcome["picture", names[n], pictures[i]]
      split("crash hang sanitizer", kinds, " "); for (i in kinds) bad["", kinds[i]] += bad[names[n], kinds[i]]
    }
    row("", "all")
  }' "$SWEEP_OUT/files.tsv"

echo
awk -F '\t' 'NR > 1 && ($4 == "refused") { print "refused: " $2 ": " $9 }' "$SWEEP_OUT/files.tsv" >"$SWEEP_OUT/refused.txt"
echo "Rows: $SWEEP_OUT/files.tsv; refusals: $SWEEP_OUT/refused.txt; failures: $SWEEP_OUT/logs"
if awk -F '\t' 'NR > 1 && ($3 ~ /^(crash|hang|sanitizer|exit-)/ || $4 ~ /^(crash|hang|sanitizer|exit-)/) { print $3 "/" $4 ": " $2; found = 1 } END { exit !found }' \
  "$SWEEP_OUT/files.tsv"; then
  exit 1
fi
