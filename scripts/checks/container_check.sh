#!/usr/bin/env bash
# container_check.sh ROOT: runs the steps of scripts/container/Dockerfile in two copies of ROOT, a Debian 12
# (debootstrap --variant=minbase bookworm ROOT), as root and without Docker. Then draws a picture, encodes and serves as
# `nobody`, and compares the steps of ghostspace.def. Exits with 0 if all checks pass.
#
# CCACHE_DIR: cache of ccache for the build. CONTAINER_SOURCE: folder of the source in the copy instead of /src.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
base=$(readlink -f "$1")
[ -x "$base/usr/bin/dpkg" ] || { echo "container_check.sh: $base is no Debian" >&2; exit 2; }
[ "$(id -u)" -eq 0 ] || { echo "container_check.sh: chroot needs root" >&2; exit 2; }
source=${CONTAINER_SOURCE:-/src}
work=$(mktemp -d "$(dirname "$base")/container.XXXXXX")
build=$work/build final=$work/final
mounted=()
leave() {
  for ((i = ${#mounted[@]} - 1; i >= 0; --i)); do umount "${mounted[i]}" || umount --lazy "${mounted[i]}" || true; done
  if ! grep -q " $work/" /proc/mounts; then rm -rf --one-file-system "$work"; fi
}
trap leave EXIT
source "$root/scripts/checks/verify.sh"
prepare() { # COPY
  cp -a "$base" "$1"
  cp /etc/resolv.conf "$1/etc/resolv.conf"
  mount -t proc proc "$1/proc"
  mounted+=("$1/proc")
}
# The locale is that of this process, because ccache distinguishes locales.
environment=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive)
[ -z "${LC_ALL:-}" ] || environment+=(LC_ALL="$LC_ALL")
[ -z "${LANG:-}" ] || environment+=(LANG="$LANG")
inside() { # COPY COMMAND
  chroot "$1" env -i "${environment[@]}" sh -c "$2"
}
# Prints the commands of RUN of stage N of the Dockerfile.
steps() { awk -v stage="$1" '/^FROM/ { n++ } n == stage && /^RUN/ { sub(/^RUN /, ""); print }' "$root/scripts/container/Dockerfile"; }
# Prints the commands of %post of stage N of ghostspace.def.
definition() {
  awk -v stage="$1" '/^Bootstrap/ { n++; post = 0 } /^%/ { post = /^%post/; next } n == stage && post && NF { sub(/^ +/, ""); print }' \
    "$root/scripts/container/ghostspace.def"
}

for stage in 1 2; do
  verify "the images have equal steps in stage $stage" "$(steps $stage | sed 's/ && /\n/g')" "$(definition $stage)"
done

prepare "$build"
mkdir -p "$build$source"
git -C "$root" archive HEAD | tar -x -C "$build$source"
if [ -n "${CCACHE_DIR:-}" ]; then
  mkdir "$build/ccache"
  mount --bind "$CCACHE_DIR" "$build/ccache"
  mounted+=("$build/ccache")
  inside "$build" "apt-get update -qq && apt-get install -y -qq --no-install-recommends ccache >/dev/null 2>&1"
  environment+=(CCACHE_DIR=/ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache)
  environment+=(CCACHE_BASEDIR="$(dirname "$source")" CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=time_macros)
fi
status=0
while IFS= read -r step; do inside "$build" "${step//\/src/$source}" || status=$?; done < <(steps 1)
verify "the first stage builds" 0 $status
verify "a package" 1 "$(find "$build/out" -name 'ghostspace_*.deb' | wc -l)"
[ $status -eq 0 ] || exit 1

prepare "$final"
cp -a "$build/out" "$final/tmp/out"
cp "$root/scripts/container/install.sh" "$final/tmp/install.sh"
while IFS= read -r step; do inside "$final" "$step" >"$work/install.log" 2>&1 || status=$?; done < <(steps 2)
verify "the second stage installs" 0 $status
[ $status -eq 0 ] || tail -20 "$work/install.log"
verify "no compiler is in the image" "" "$(inside "$final" 'command -v c++' || true)"
printf '#VRML V2.0 utf8\nShape { appearance Appearance { material Material { } } geometry Box { } }\n' >"$final/tmp/box.wrl"
mkdir -m 777 "$final/tmp/data"
as_nobody() { chroot --userspec=nobody:nogroup "$final" env -i "${environment[@]}" HOME=/tmp/data sh -c "$1"; }
verify "it draws a picture" 0 "$(as_nobody 'ghostspace --snapshot /tmp/data/box.png --size 128x128 --timeout 300 /tmp/box.wrl' >/dev/null 2>&1; echo $?)"
verify "it encodes" 0 "$(as_nobody 'ghostspace encode /tmp/box.wrl /tmp/data/box.qnv' >/dev/null 2>&1; echo $?)"
# shellcheck disable=SC2016  # the shell in the image expands these
as_nobody 'ghostspace serve /tmp/data --http 28080 --cache /tmp/cache --log /tmp/access & server=$!; sleep 3
  ghostspace fetch --json http://127.0.0.1:28080/box.qnv; kill $server; wait' >"$work/fetch.json" 2>/dev/null || true
verify "it serves" 1 "$(grep -c '"complete": true' "$work/fetch.json")"
if [ -e "$build/out/ghostspace-mpi" ]; then
  verify "ghostspace-mpi runs" 0 "$(as_nobody 'mpirun --oversubscribe -n 2 ghostspace-mpi encode /tmp/box.wrl /tmp/data/mpi.qnv' >/dev/null 2>&1; echo $?)"
  verify "with the same bytes" "$(sha256sum <"$final/tmp/data/box.qnv")" "$(sha256sum <"$final/tmp/data/mpi.qnv")"
fi
du -smx "$final" 2>/dev/null | sed 's/\t.*/ MB in the image/'
cp "$final/tmp/data/box.png" "${TMPDIR:-/tmp}/ghostspace-container.png"
[ $failures -eq 0 ]
