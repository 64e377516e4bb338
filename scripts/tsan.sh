#!/usr/bin/env bash
# tsan.sh: builds the parts with threads with ThreadSanitizer and runs their tests: loader, servers, cells, control, and
# the worlds and streams that they load. Fails on any race. Takes about fifteen minutes on two cores.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-dependencies.sh" >&2
cd "$root"
cmake --preset tsan >/dev/null
cmake --build --preset tsan --target ghostspace net_tests app_tests
export TSAN_OPTIONS="exitcode=66 suppressions=$root/scripts/tsan.supp ${TSAN_OPTIONS:-}"
build/tsan/tests/net_tests
build/tsan/tests/app_tests -# "[#world_loading_test],[#world_reader_test],[#world_loader_test],[#cell_stream_test],[#serve_test],[#documents_test],[#outline_world_test],[#session_test],[#url_requests_test],[#control_files_test],[#control_program_test]"
echo "tsan.sh: no races"
