#!/usr/bin/env bash
# package_check.sh PACKAGE.deb ROOT: installs the package as root in ROOT, a separate Debian 12 (debootstrap). Runs it,
# asks the desktop's tools for file types and their programs, and removes it again. Exits with 0 if all checks pass.
set -euo pipefail

package=$(readlink -f "$1")
root=$(readlink -f "$2")
[ -x "$root/usr/bin/dpkg" ] || { echo "package_check.sh: $root is no Debian" >&2; exit 2; }
source "$(dirname "${BASH_SOURCE[0]}")/verify.sh"
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }

mounted=
leave() { [ -z "$mounted" ] || umount "$root/proc"; }
trap leave EXIT
if ! [ -e "$root/proc/self" ]; then
  mount -t proc proc "$root/proc"
  mounted=1
fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
cp "$package" "$root/tmp/ghostspace.deb"
printf '#VRML V2.0 utf8\nShape { appearance Appearance { material Material { } } geometry Box { } }\n' >"$root/tmp/box.wrl"
cp "$root/tmp/box.wrl" "$root/tmp/unnamed"
printf '[GhostSpace link]\nURL=http://127.0.0.1/a.qnv\n' >"$root/tmp/a.gslink"

inside apt-get update -qq
inside apt-get install -y -qq --no-install-recommends shared-mime-info desktop-file-utils xdg-utils libfile-mimeinfo-perl >/dev/null
inside sh -c 'cd / && find etc usr var/lib ! -type d ! -path "var/lib/dpkg/*" ! -path "var/lib/apt/*"' | sort >"$root/tmp/before"
inside apt-get install -y -qq --no-install-recommends /tmp/ghostspace.deb >/dev/null
inside dpkg -L ghostspace >"$root/tmp/installed"

verify "it is installed" "install ok installed" "$(inside dpkg-query -W -f '${Status}' ghostspace)"
verify "it runs" 0 "$(inside ghostspace --version >/dev/null; echo $?)"
verify "it checks a world" 0 "$(inside ghostspace check /tmp/box.wrl >/dev/null 2>&1; echo $?)"
verify "it draws a world" 0 "$(inside ghostspace --snapshot /tmp/box.png --timeout 300 --size 128x128 /tmp/box.wrl >/dev/null 2>&1; echo $?)"
verify "it draws the demo world" 0 "$(inside ghostspace --snapshot /tmp/demo.png --timeout 300 --size 256x192 >/dev/null 2>&1; echo $?)"
verify "a world is known by its name" model/vrml "$(inside mimetype -b /tmp/box.wrl)"
verify "a world is known by its first bytes" model/vrml "$(inside mimetype -b /tmp/unnamed)"
verify "a link is known" application/x-ghostspace-link "$(inside mimetype -b /tmp/a.gslink)"
for type in model/vrml x-world/x-vrml model/x-qnv application/x-ghostspace-link x-scheme-handler/ghostspace; do
  verify "$type opens with it" org.ghostspace.GhostSpace.desktop "$(inside xdg-mime query default $type)"
done
verify "the thumbnailer draws" 0 "$(inside sh -c 'eval "$(sed -n "s/^Exec=//p" /usr/share/thumbnailers/ghostspace.thumbnailer | sed "s/%s/128/g; s#%o#/tmp/thumbnail.png#; s#%i#/tmp/box.wrl#")"' </dev/null >/dev/null 2>&1; echo $?)"
for file in man/man1/ghostspace.1 bash-completion/completions/ghostspace zsh/vendor-completions/_ghostspace \
  fish/vendor_completions.d/ghostspace.fish icons/hicolor/48x48/apps/org.ghostspace.GhostSpace.png \
  metainfo/org.ghostspace.GhostSpace.metainfo.xml ghostspace/worlds/demo.wrl; do
  verify "/usr/share/$file is there" yes "$([ -e "$root/usr/share/$file" ] || [ -e "$root/usr/share/$file.gz" ] && echo yes)"
done

inside apt-get remove --purge -y -qq ghostspace >/dev/null
inside apt-get autoremove --purge -y -qq >/dev/null
verify "it is gone" "" "$(inside sh -c 'command -v ghostspace' || true)"
verify "nothing of it is left" "" "$(sed -n 's#^/##p' "$root/tmp/installed" | while read -r file; do
  if [ -f "$root/$file" ] || [ -L "$root/$file" ]; then echo "$file"; fi; done)"
verify "its types open with nothing" "" "$(inside xdg-mime query default model/x-qnv)"
rm -f "$root"/tmp/{ghostspace.deb,box.wrl,unnamed,a.gslink,box.png,demo.png,thumbnail.png,before,installed}
[ $failures -eq 0 ]
