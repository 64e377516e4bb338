#!/usr/bin/env bash
# Checks rules that a compiler does not: arrows between rooms, headers that belong to one folder, and the writing rules of docs/style.md.
#   tests/style_test.sh                    runs all checks
#   tests/style_test.sh --list RULE ROOM   lists the violations of a writing rule in a room
#   tests/style_test.sh --lower            lowers the ceilings in tests/style_ceilings.txt to the present counts
set -u
cd "$(dirname "$0")/.."
failed=0
report() { if [ -n "$2" ]; then printf '%s\n%s\n' "$1" "$2"; failed=1; fi; }

files=$(find app vrml qnv net render base tests bench -name '*.h' -o -name '*.cpp' -o -name '*.inc' | sort)
sources() { local IFS='|'; grep -E "^($*)/.*\.(h|cpp)\$" <<<"$files"; }

# Writing rules. Older text violates them, so each room has a ceiling per rule, which may only fall.
violations() { printf "%s\n" README.md */README.md "$files" | xargs awk -f tests/style_prose.awk; }
counts() { cut -f 1,2 | sort | uniq -c | awk '{ print $2, $3, $1 }'; }
case ${1-} in
  --list)
    violations | awk -F '\t' -v rule="${2-}" -v room="${3-}" '$1 == rule && $2 == room { print $3 }'
    exit ;;
  --lower)
    lowered=$(violations | counts | awk 'NR == FNR { now[$1 " " $2] = $3; next }
      /^#/ { print; next }
      { n = now[$1 " " $2] + 0; if (n > $3) n = $3; if (n > 0) print $1, $2, n }' - tests/style_ceilings.txt)
    printf '%s\n' "$lowered" >tests/style_ceilings.txt
    exit ;;
esac

if command -v python3 >/dev/null; then
  conformance=$(mktemp)
  trap 'rm -f "$conformance"' EXIT
  scripts/conformance.sh --check >"$conformance" 2>&1 &  # takes longest
fi
# All includes of the rooms, FILE:LINE:TEXT.
includes=$(sources app vrml qnv net render base | xargs grep -n '#include')
# Prints FILE TARGET for includes of other files of the rooms.
own_includes() { sed -nE 's|^([^:]+):.*#include "((app\|vrml\|qnv\|net\|render\|base)/[^"]+)".*|\1 \2|p' <<<"$includes"; }
report "A room includes a room that it must not know (app -> render -> vrml, qnv; app -> net; all -> base):" \
  "$(own_includes | awk '{ from = $1; to = $2; sub(/\/.*/, "", from); sub(/\/.*/, "", to) }
    from != to && (from == "base" || to != "base") && from != "app" && !(from == "render" && (to == "vrml" || to == "qnv")) { print }')"
report "Folders of a room include each other:" \
  "$(own_includes | awk '{ from = $1; to = $2; sub(/\/[^\/]*$/, "", from); sub(/\/[^\/]*$/, "", to)
      room = from; sub(/\/.*/, "", room) }
    from != to && index(to, room "/") == 1 { print from, to }' | sort -u | tsort 2>&1 >/dev/null)"
# Code that reads nodes uses the columns of the node table (NodeType::read_as, role, behaviour, ...).
types=$(grep -ohE '^ +\{"[A-Z][A-Za-z]*", "[0-9G]' vrml/nodes/*.cpp | grep -oE '[A-Z][A-Za-z]+' | grep -v '^GhostSpace' | paste -sd '|')
report "Node types are told apart by the columns of the node table, not by their names:" \
  "$(sources app render vrml bench | grep -vE '^vrml/(nodes/|inventor/|syntax/stand_ins)' | xargs -r grep -nE \
    "type(\(\))?(->|\.)name *[=!]= *[^;]*\"|[=!]= *\"($types)\"|\"($types)\" *[=!]=|(make|create|resolve_as|built_in_node_type|node_of)\(([^;\"]*, )?\"($types)\"|\{\"($types)\"" |
    grep -vE 'input(->|\.)type == "|^app/interface/|^app/formats/content_types')"
belongs() { report "$1 belongs in $2:" "$(grep -E "#include $3" <<<"$includes" | grep -vE "^$4" | cut -d : -f 1 | sort -u)"; }
belongs GLFW app/window/window.cpp '.*GLFW/glfw3\.h' 'app/window/window\.cpp:'
belongs 'Dear ImGui' app/interface/ '[<"]imgui' app/interface/
spidermonkey='[<"](js/|jsapi|jsfriendapi|app/script/(browser/|engine/|natives|script_world|program|assignments|script_(library|messages)))'
belongs SpiderMonkey app/script/ "$spidermonkey" app/script/
report "app/script/script_runner.h includes SpiderMonkey:" "$(grep -E "^app/script/script_runner\.h:.*#include $spidermonkey" <<<"$includes")"
belongs MPI app/cluster/ '<mpi\.h>' 'app/cluster/|app/insitu/include/'
belongs OpenGL render/ '<GL/' render/
report "Libraries never print, exit or abort:" \
  "$(sources vrml qnv net render base | xargs -r grep -nE 'std::(cout|cerr|exit|abort)|[^a-z_](printf|fprintf|puts)\(|[^_a-z]exit\(')"
report "What is printed goes through app/base/console.cpp, which keeps controls off the terminal:" \
  "$(sources app | grep -vE '^app/(base/console.cpp$|insitu/examples/)' | xargs -r grep -nE 'std::(cout|cerr|clog)|[^a-z_](printf|fprintf|vfprintf|puts|fputs|fwrite|perror)\(')"
report "Non-ASCII source:" "$(sources app vrml qnv net render base tests bench | xargs -r grep -nP '[^\x00-\x7F]')"
report "Folders have more than 25 files:" "$(find app vrml qnv net render base tests bench scripts -type f -not -path 'tests/*/corpus/*' \
  -regex '.*\.\(h\|cpp\|inc\|py\|sh\)' -printf '%h\n' | sort | uniq -c | awk '$1 > 25 { print $2 ": " $1 }')"
report "Header without #pragma once:" \
  "$(sources app vrml qnv net render base | grep '\.h$' | xargs -r grep -L '#pragma once')"
report "Names in anonymous namespaces clash in unity builds of their room:" \
  "$(sources app vrml qnv net render base tests | grep -E '\.cpp$' | grep -v '^tests/fuzz/' | xargs awk -f tests/style_names.awk | sort)"
report "CTest cuts the name of a test at a semicolon:" "$(grep -rnE 'TEST_CASE\("[^"]*;' tests --include='*.cpp')"

# Prints paths in backticks that do not exist, as DOCUMENT:LINE: PATH. Checks a path if its first part is a folder of the root or of
# the document's folder. A path may omit its extension, contain `*`, or name a fuzz target, which is a folder of tests/fuzz/corpus.
# Skips placeholders in capitals such as NAME, and build/. The caller omits docs/scripts.md, which names files of users, and the
# generated page docs/conformance.md.
missing_paths() {
  local document line path folder top at
  grep -noE '`[A-Za-z0-9_*][A-Za-z0-9_.*-]*(/[A-Za-z0-9_.*-]+)+/?`' "$@" | tr -d '`' | while IFS=: read -r document line path; do
    [[ $path =~ (NAME|ROOM|FILE|NNNN) || $path == build/* ]] && continue
    folder=${document%/*} top=${path%%/*}
    [ "$folder" = "$document" ] && folder=.
    [ -d "$top" ] || [ -d "$folder/$top" ] || continue
    for at in . "$folder" tests/fuzz/corpus; do
      if compgen -G "$at/$path" >/dev/null || compgen -G "$at/${path%/}.*" >/dev/null; then continue 2; fi
    done
    echo "$document:$line: $path"
  done
}
report "Documents name files that do not exist:" "$(missing_paths $(printf '%s\n' README.md */*.md docs/decisions/*.md |
  grep -vxE 'docs/(conformance|scripts)\.md'))"

# The search itself works: it finds the violations of these samples, and nothing else.
sample='/// Likewise, whose name is given.
/// The row. Null: none.
int whose();  // where it is
const char* url = "http://who";  // noun phrase
// Returns the row.
TEST_CASE("what is lost comes again") {}'
row="| short | $(printf 'word %.0s' {1..41})|"
found=$( (awk -f tests/style_prose.awk <<<"$sample"; awk -v tables=1 -f tests/style_prose.awk <<<"$row") | counts | tr '\n' ';')
[ "$found" = 'cell root 1;likewise root 1;opening root 2;result root 1;title root 1;who root 1;' ] ||
  report "tests/style_prose.awk does not find the violations of its samples, but:" "$found"
samples=$(mktemp -d)
printf 'namespace gs {\nnamespace {\nconstexpr int kA = 1, kB[] = {kC};\nint f(int x) {\n}\n}  // namespace\nconstexpr int kD = 1;\n' >"$samples/a.cpp"
sed 's/kB/kE/; s/^int/template <int>\nint/' "$samples/a.cpp" >"$samples/b.cpp"
found=$(awk -f tests/style_names.awk "$samples"/?.cpp | cut -d : -f 1)
rm -r "$samples"
[ "$found" = ' gs kA' ] || report "tests/style_names.awk does not find the name of its samples, but:" "$found"
report "Too many violations of writing rules (docs/style.md; tests/style_test.sh --list RULE ROOM shows them):" \
  "$(violations | counts | awk 'NR == FNR { if ($0 !~ /^#/) ceiling[$1 " " $2] = $3; next }
    $3 > ceiling[$1 " " $2] + 0 { print $1, $2 ": " $3 " violations; the ceiling is " ceiling[$1 " " $2] + 0 }' tests/style_ceilings.txt -)"
# Older subjects are longer. A checkout without history has nothing to check.
last_unchecked=9c796de599b16362c2385dd7279fac8057295c45
if git merge-base --is-ancestor $last_unchecked HEAD 2>/dev/null; then
  report "Commit subjects have at most 72 characters:" \
    "$(git log --no-merges --format='%h %s' $last_unchecked..HEAD | awk '{ id = $1; sub(/^[^ ]+ /, "") } length($0) > 72 { print id, $0 }')"
fi
if [ -n "${conformance-}" ]; then
  wait
  report "docs/conformance.tsv names no such test, or its page is stale:" "$(cat "$conformance")"
fi
exit $failed
