#!/usr/bin/env bash
# install.sh FOLDER: installs what build.sh has put into FOLDER. A step of the Dockerfile and of ghostspace.def.
set -euo pipefail

packages=("$(readlink -f "$1")"/ghostspace_*.deb)
if [ -e "$1/ghostspace-mpi" ]; then
  packages+=(openmpi-bin libhdf5-openmpi-103-1)
  install -m 755 "$1/ghostspace-mpi" /usr/bin/ghostspace-mpi
fi
apt-get update -qq
DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${packages[@]}" libosmesa6 openssh-client
rm -rf /var/lib/apt/lists/*
ghostspace --version
