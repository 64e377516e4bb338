#!/usr/bin/env bash
# install-dependencies.sh [--cluster] [PACKAGE...]: installs the missing Debian 12 packages that GhostSpace needs, and the
# given packages; --cluster adds MPI. Needs neither network nor root if no package is missing.
set -euo pipefail

# ghostspace-mpi
cluster=()
if [ "${1:-}" = --cluster ]; then
  cluster=(openmpi-bin libopenmpi-dev)
  shift
fi

packages=(
  # tools
  cmake ninja-build g++
  # window, user interface, command line
  libglfw3-dev libimgui-dev libcli11-dev
  # mathematics, numbers, JSON, importers
  libglm-dev libfast-float-dev nlohmann-json3-dev libtinygltf-dev
  # images and compression
  libpng-dev libjpeg62-turbo-dev libgif-dev zlib1g-dev libzstd-dev libwebp-dev libminizip-dev
  # movies and sounds: headers, and libraries that are opened at run time
  libavutil-dev libavcodec-dev libavformat-dev libswscale-dev
  # sound devices; MIDI, with a sound font
  libopenal-dev libfluidsynth3 timgm6mb-soundfont
  # fonts: shaping, and at least one font
  libfreetype-dev libfontconfig-dev libharfbuzz-dev libfribidi-dev fonts-dejavu-core
  # volumes
  libexpat1-dev libhdf5-dev libblosc-dev liblz4-dev libbz2-dev liblzma-dev libtiff-dev libgdcm-dev
  # network
  libcurl4-openssl-dev libisal-dev libmicrohttpd-dev openssh-client
  # Scripts
  libmozjs-102-dev pkg-config
  # OpenGL headers; rendering without a display
  libgl-dev libosmesa6-dev libosmesa6
  # tests
  catch2 nginx-light python3 openssh-sftp-server
  "${cluster[@]}" "$@"
)

fail() {
  printf '%s: %s\n' "$(basename "$0")" "$1" >&2
  exit 1
}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  fail "this system has no apt; install what corresponds to these Debian 12 packages by hand: ${packages[*]}"
fi

missing=()
for package in "${packages[@]}"; do
  # shellcheck disable=SC2016  # dpkg-query expands the format itself
  state=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$state" = installed ] || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "All packages that GhostSpace needs are installed."
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || fail "these packages are missing, and there is neither root nor sudo to install them: ${missing[*]}"
  as_root=(sudo)
fi

echo "Installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq || fail "apt-get update failed; is there a network?"
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
  apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null ||
  fail "apt-get could not install: ${missing[*]}"
echo "Installed."
