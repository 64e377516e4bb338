#!/bin/sh
# Runs the tests of Scripts again, with their programs in confined child processes.
# Usage: scripts/checks/scripts_in_child.sh [TIMES]   (after scripts/test.sh, which builds the tests)
set -eu
cd "$(dirname "$0")/../.."
export GHOSTSPACE_SCRIPTS_IN_CHILD=1
tests=
for name in script_events script_types script_browser script_lifetime script_habits script_evaluation contact_browser \
  x3d_fields x3d_scene private_reads script_effects session_scripts; do
  tests="$tests${tests:+,}[#${name}_test]"
done
for _ in $(seq "${1:-1}"); do
  build/release/tests/app_tests --filenames-as-tags "$tests"
done
