#!/bin/sh
# Runs sessions over simulated networks: loader, HTTP, cells and server, with delays, losses, cuts and restarts.
# Usage: scripts/simulate.sh [SEEDS [FIRST]]   (default: 1000 seeds from 1 on)
# Each seed runs twice and must repeat bit for bit. To see one: build/release/tests/simulate --print SEED
set -eu
cd "$(dirname "$0")/.."
cmake --preset release > /dev/null
cmake --build --preset release --target simulate
exec build/release/tests/simulate "${2:-1}" "${1:-1000}"
