#!/usr/bin/env bash
# package.sh [--check ROOT]: builds the Debian package build/release/package/ghostspace_VERSION_ARCH.deb, checks it, and
# prints its name and SHA-256.
#   --check ROOT  as root: also installs it in ROOT, a Debian 12 (`debootstrap --variant=minbase bookworm ROOT`), runs
#                 it there, queries its file associations, and removes it again
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
check=
if [ "${1:-}" = --check ] && [ -n "${2:-}" ]; then
  check=$(cd "$2" && pwd)
elif [ $# -gt 0 ]; then
  sed -n '2,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  exit 2
fi

"$root/scripts/install-dependencies.sh" dpkg-dev file
cd "$root"
cmake --preset release >/dev/null
cmake --build --preset release --target ghostspace insitu_library desktop_files
cpack --config build/release/CPackConfig.cmake >/dev/null
package=$(find build/release/package -maxdepth 1 -name 'ghostspace_*.deb' -printf '%T@ %p\n' | sort -n | tail -1 | cut -d' ' -f2)

# Check desktop and shell files with the validators of their formats. Report a validator that is not installed.
made=build/release/desktop
examine() {
  if command -v "$1" >/dev/null; then
    "$@"
  else
    echo "package.sh: $1 is not installed; not examined: ${*: -1}" >&2
  fi
}
examine desktop-file-validate $made/org.ghostspace.GhostSpace.desktop
examine appstreamcli validate --no-net $made/org.ghostspace.GhostSpace.metainfo.xml
examine xmllint --noout $made/org.ghostspace.GhostSpace.xml
examine bash -n $made/ghostspace.bash
examine zsh -n $made/ghostspace.zsh
examine fish --no-execute $made/ghostspace.fish

if [ -n "$check" ]; then
  "$root/scripts/checks/package_check.sh" "$package" "$check"
fi
sha256sum "$package"
