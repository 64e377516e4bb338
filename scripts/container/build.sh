#!/usr/bin/env bash
# build.sh FOLDER: builds the Debian package, and ghostspace-mpi if the tree has it, and copies both to FOLDER. A step of
# the Dockerfile and of ghostspace.def.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
mkdir -p "$1"
"$root/scripts/install-dependencies.sh" dpkg-dev libopenmpi-dev libhdf5-openmpi-dev openmpi-bin
"$root/scripts/package.sh"
cd "$root"
if cmake --build --preset release --target help | grep -q '^ghostspace-mpi:'; then
  cmake --build --preset release --target ghostspace-mpi
  strip -o "$1/ghostspace-mpi" build/release/ghostspace-mpi
fi
cp build/release/package/ghostspace_*.deb "$1/"
