#!/usr/bin/env bash
# The rules of the house that a compiler does not check: arrows between the rooms, and who may use what.
set -u
cd "$(dirname "$0")/.."
failed=0
report() { if [ -n "$2" ]; then printf '%s\n%s\n' "$1" "$2"; failed=1; fi; }

sources() { find "$@" -name '*.h' -o -name '*.cpp' | sort; }
for room in vrml qnv net render; do
  case $room in render) allowed='render|vrml|qnv' ;; *) allowed=$room ;; esac
  report "$room/ includes a room that it must not know:" \
    "$(sources $room | xargs -r grep -nE '#include "(app|vrml|qnv|net|render)/' | grep -vE "#include \"($allowed)/")"
done
# Inside the rooms, too, arrows between folders hold one way.
for room in app vrml qnv net render; do
  report "$room/ has folders that include each other:" "$(sources $room | xargs -r grep -oE '#include "'$room'/[^"]+"' |
    sed -E 's|/[^/]+:#include "| |; s|/[^/]+"$||' | awk '$1 != $2' | sort -u | tsort 2>&1 >/dev/null)"
done
# Who reads a node goes by the columns of its row (NodeType::read_as, role, behaviour, ...).
types=$(grep -ohE '^ +\{"[A-Z][A-Za-z]*", "[0-9G]' vrml/nodes/*.cpp | grep -oE '[A-Z][A-Za-z]+' | grep -v '^GhostSpace' | paste -sd '|')
report "Node types are told apart by the columns of the node table, not by their names:" \
  "$(sources app render vrml bench | grep -vE '^vrml/(nodes/|syntax/stand_ins)' | xargs -r grep -nE \
    "type(\(\))?(->|\.)name *[=!]= *[^;]*\"|[=!]= *\"($types)\"|\"($types)\" *[=!]=|(make|create|resolve_as|built_in_node_type|node_of)\(([^;\"]*, )?\"($types)\"|\{\"($types)\"" |
    grep -vE 'input(->|\.)type == "|^app/interface/|^app/formats/content_types')"
report "GLFW belongs in app/window/window.cpp:" "$(sources app render vrml qnv net | grep -v '^app/window/window.cpp$' | xargs -r grep -ln 'GLFW/glfw3.h')"
report "Dear ImGui belongs in app/interface/:" "$(sources app render vrml qnv net | grep -v '^app/interface/' | xargs -r grep -ln '#include [<"]imgui')"
report "SpiderMonkey belongs in app/script/, and out of script_runner.h:" "$( (sources app render vrml qnv net | grep -v '^app/script/'; echo app/script/script_runner.h) |
  xargs -r grep -lnE '#include [<"](js/|jsapi|jsfriendapi|app/script/(engine|script_world))')"
report "GL headers belong in render/:" "$(sources app vrml qnv net | xargs -r grep -lnE '#include <GL/')"
report "Libraries never print, exit or abort:" \
  "$(sources vrml qnv net render | xargs -r grep -nE 'std::(cout|cerr|exit|abort)|[^a-z_](printf|fprintf|puts)\(|[^_a-z]exit\(')"
report "What is printed goes through app/base/console.cpp, which keeps controls off the terminal:" \
  "$(sources app | grep -v '^app/base/console.cpp$' | xargs -r grep -nE 'std::(cout|cerr|clog)|[^a-z_](printf|fprintf|vfprintf|puts|fputs|fwrite|perror)\(')"
report "Non-ASCII source:" "$(sources app vrml qnv net render tests bench | xargs -r grep -nP '[^\x00-\x7F]')"
report "Header without #pragma once:" \
  "$(sources app vrml qnv net render | grep '\.h$' | xargs -r grep -L '#pragma once')"
report "CTest cuts the name of a test at a semicolon:" "$(grep -rnE 'TEST_CASE\("[^"]*;' tests --include='*.cpp')"
if command -v python3 >/dev/null; then
  report "docs/conformance.tsv names no such test, or its page is stale:" "$(scripts/conformance.sh --check 2>&1)"
fi
exit $failed
