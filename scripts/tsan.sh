#!/usr/bin/env bash
# tsan.sh: builds the program and the tests of parts with threads with ThreadSanitizer, and runs them: loader, servers,
# cells, control, the worlds and streams that they load, and children for decoders and Scripts. If Xvfb and xdotool are
# installed, also uses a window as a user does (window_check.py). Fails on any race. Takes about half an hour on two
# cores.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
"$root/scripts/install-dependencies.sh" >&2
cd "$root"
cmake --preset tsan >/dev/null
cmake --build --preset tsan --target ghostspace net_tests app_tests
export TSAN_OPTIONS="exitcode=66 suppressions=$root/scripts/tsan.supp ${TSAN_OPTIONS:-}"
build/tsan/tests/net_tests
files=(world_loading world_reader world_loader cell_stream cell_view cell_volume serve documents outline_world session
  url_requests control_files control_program decoder_process media_decoding movie_texture confined_volume file_requests
  program_process session_scripts)
build/tsan/tests/app_tests -# "$(printf '[#%s_test],' "${files[@]}")"
if command -v Xvfb >/dev/null && command -v xdotool >/dev/null; then
  rm -f build/tsan/window-report.*
  # A slow window may miss a step of the check; only reports of races count.
  TSAN_OPTIONS="$TSAN_OPTIONS log_path=$root/build/tsan/window-report" GHOSTSPACE=build/tsan/ghostspace \
    scripts/checks/window_check.py || true
  if compgen -G 'build/tsan/window-report.*' >/dev/null; then
    cat build/tsan/window-report.*
    exit 1
  fi
fi
echo "tsan.sh: no races"
