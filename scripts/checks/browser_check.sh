#!/usr/bin/env bash
# browser_check.sh [FOLDER]: checks that a click in a web browser opens a scene in GhostSpace while the scene loads.
# Runs under Xvfb with Firefox ESR and Chromium, if they are installed. Clicks on link files on pages of `ghostspace
# serve` and of nginx, and on a ghostspace: URL on the page of nginx.
#
# Checks that the browser fetched the link but not the scene, and that GhostSpace fetched the scene. Checks that one
# window opened with the scene's name, and that the next click used this window. Screenshots go to FOLDER (default: a
# new folder, printed at the end). Exits with 0 if all checks pass.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
ghostspace=$root/build/release/ghostspace
made=$root/build/release/desktop
work=$(mktemp -d /tmp/ghostspace-browsers.XXXXXX)
pictures=${1:-$work/pictures}
mkdir -p "$pictures"
for tool in Xvfb xdotool import nginx gio xdg-mime update-mime-database update-desktop-database; do
  command -v $tool >/dev/null || { echo "browser_check.sh: $tool is missing" >&2; exit 2; }
done
[ -x "$ghostspace" ] && [ -d "$made" ] || { echo "browser_check.sh: build GhostSpace first (scripts/run.sh)" >&2; exit 2; }

started=()
leave() {
  for ((i = ${#started[@]} - 1; i >= 0; --i)); do kill "${started[i]}" 2>/dev/null || true; done
  wait 2>/dev/null || true
}
trap leave EXIT
failures=0
wrong() { echo "WRONG: $1"; failures=$((failures + 1)); }
verify() { if [ "$2" = "$3" ]; then echo "ok: $1"; else wrong "$1: expected '$2', found '$3'"; fi; }
# Repeats COMMAND until it succeeds, at most for SECONDS.
until_true() {
  local end=$((SECONDS + $1))
  shift
  while [ $SECONDS -lt $end ]; do
    if "$@" >/dev/null 2>&1; then return 0; fi
    sleep 0.3
  done
  return 1
}

# Use a separate user folder, in which GhostSpace is installed.
export HOME=$work/home XDG_RUNTIME_DIR=$work/runtime XDG_DATA_HOME=$work/home/.local/share XDG_CONFIG_HOME=$work/home/.config
export XDG_CACHE_HOME=$work/home/.cache
unset DBUS_SESSION_BUS_ADDRESS WAYLAND_DISPLAY
# Choose a desktop with tools that use shared-mime-info (gio), as all desktops do. Otherwise xdg-open would ask file(1).
export XDG_CURRENT_DESKTOP=GNOME
mkdir -p "$XDG_RUNTIME_DIR" "$XDG_DATA_HOME"/{applications,mime/packages} "$XDG_CONFIG_HOME" "$XDG_CACHE_HOME" "$HOME/bin"
chmod 700 "$XDG_RUNTIME_DIR"
# Log the arguments with which the browser starts the program.
printf '#!/bin/sh\nprintf "%%s\\n" "$*" >>"%s"\nexec "%s" "$@" 2>>"%s"\n' "$work/calls" "$ghostspace" "$work/ghostspace.log" \
  >"$HOME/bin/ghostspace"
chmod +x "$HOME/bin/ghostspace"
export PATH=$HOME/bin:$PATH
sed "s#^Exec=ghostspace#Exec=$HOME/bin/ghostspace#; /^TryExec/d" "$made/org.ghostspace.GhostSpace.desktop" \
  >"$XDG_DATA_HOME/applications/org.ghostspace.GhostSpace.desktop"
cp "$made/org.ghostspace.GhostSpace.xml" "$XDG_DATA_HOME/mime/packages/"
update-mime-database "$XDG_DATA_HOME/mime"
update-desktop-database "$XDG_DATA_HOME/applications"
for type in application/x-ghostspace-link x-scheme-handler/ghostspace; do
  xdg-mime default org.ghostspace.GhostSpace.desktop $type
done

# Scenes: two streams with different names.
site=$work/site
mkdir -p "$site"
"$ghostspace" encode --vectors 60000 "$root/assets/worlds/demo-boat.wrl" "$site/boat.qnv"
printf '#VRML V2.0 utf8\nWorldInfo { title "A second scene" }\nShape { appearance Appearance { material Material { } } geometry Sphere { } }\n' \
  >"$site/second.wrl"

Xvfb -displayfd 3 -screen 0 1280x900x24 -nolisten tcp 3>"$work/display" >/dev/null 2>&1 &
started+=($!)
until_true 20 test -s "$work/display" || { echo "browser_check.sh: Xvfb does not start" >&2; exit 2; }
DISPLAY=:$(cat "$work/display")
export DISPLAY

unset http_proxy https_proxy HTTP_PROXY HTTPS_PROXY all_proxy ALL_PROXY
"$ghostspace" serve --http 0 --log "$work/serve.log" "$site" 2>"$work/serve.err" &
started+=($!)
until_true 20 grep -q 'serving .* on http' "$work/serve.err"
serve_url=$(sed -n 's#.* on \(http://[^ ]*/\).*#\1#p' "$work/serve.err" | head -1)

# nginx serves a page with link files from its folder, and with a URL of the scheme.
port=$((20000 + $$ % 20000))
mkdir -p "$work/nginx" "$work/www"
cp "$site/boat.qnv" "$site/second.wrl" "$work/www/"
nginx_url=http://127.0.0.1:$port/
printf '[GhostSpace link]\nURL=%sboat.qnv\nBudget=40000\n' "$nginx_url" >"$work/www/boat.qnv.gslink"
printf '<!DOCTYPE html><title>Scenes</title><p><a href="boat.qnv.gslink">boat</a> <p><a href="ghostspace:%ssecond.wrl">second</a>\n' \
  "$nginx_url" >"$work/www/index.html"
cat >"$work/nginx.conf" <<CONF
$([ "$(id -u)" -ne 0 ] || echo "user root;")
daemon off; pid $work/nginx/pid; error_log $work/nginx/error.log; worker_processes 1;
events { worker_connections 64; }
http {
  types { text/html html; application/x-ghostspace-link gslink; model/x-qnv qnv; model/vrml wrl; }
  log_format agents '"\$request" \$status "\$http_user_agent"';
  access_log $work/nginx/access.log agents;
  client_body_temp_path $work/nginx/a; proxy_temp_path $work/nginx/b; fastcgi_temp_path $work/nginx/c;
  uwsgi_temp_path $work/nginx/d; scgi_temp_path $work/nginx/e;
  server { listen 127.0.0.1:$port; root $work/www; }
}
CONF
nginx -c "$work/nginx.conf" -p "$work/nginx" 2>/dev/null &
started+=($!)
until_true 20 curl -sf -o /dev/null "$nginx_url" || { echo "browser_check.sh: nginx does not start" >&2; exit 2; }

# Makes a browser profile of a user who has confirmed once that GhostSpace opens such links.
profile() {
  case $1 in
    firefox-esr)
      mkdir -p "$work/firefox"
      cat >"$work/firefox/handlers.json" <<'JSON'
{"defaultHandlersVersion":{"en-US":4},"mimeTypes":{"application/x-ghostspace-link":{"action":4,"extensions":["gslink"],"ask":false}},"schemes":{"ghostspace":{"action":4,"ask":false}}}
JSON
      cat >"$work/firefox/user.js" <<'JS'
user_pref("browser.shell.checkDefaultBrowser", false);
user_pref("browser.aboutwelcome.enabled", false);
user_pref("browser.startup.homepage_override.mstone", "ignore");
user_pref("datareporting.policy.dataSubmissionEnabled", false);
user_pref("datareporting.policy.dataSubmissionPolicyBypassNotification", true);
user_pref("termsofuse.bypassNotification", true);
user_pref("network.captive-portal-service.enabled", false);
user_pref("network.connectivity-service.enabled", false);
user_pref("app.update.enabled", false);
user_pref("toolkit.telemetry.reportingpolicy.firstRun", false);
user_pref("browser.download.alwaysOpenPanel", false);
user_pref("security.external_protocol_requires_permission", false);
user_pref("network.protocol-handler.external.ghostspace", true);
user_pref("network.protocol-handler.warn-external.ghostspace", false);
user_pref("accessibility.tabfocus", 7);
JS
      ;;
    chromium)
      mkdir -p "$work/chromium/Default"
      cat >"$work/chromium/Default/Preferences" <<JSON
{"download":{"extensions_to_open":"gslink","prompt_for_download":false},"browser":{"check_default_browser":false},
"protocol_handler":{"allowed_origin_protocol_pairs":{"${nginx_url%/}":{"ghostspace":true}}}}
JSON
      ;;
  esac
}
browse() { # BROWSER URL
  case $1 in
    firefox-esr) exec firefox-esr --no-remote --profile "$work/firefox" "$2" ;;
    chromium)
      exec chromium --no-sandbox --disable-gpu --no-first-run --no-default-browser-check --password-store=basic \
        --user-data-dir="$work/chromium" --window-size=1000,800 "$2"
      ;;
  esac >"$work/$1.log" 2>&1 &
  browser=$!
  started+=("$browser")
}
# Finds a link by its text with the browser's search. Enter then follows the link. A busy machine takes seconds to open
# the search; earlier key presses would go to the page.
click_link() { # BROWSER_WINDOW WORDS
  local busy
  busy=$(awk -v cores="$(nproc)" '{ pause = $1 / cores; print (pause < 1 ? 1 : pause > 6 ? 6 : pause) }' /proc/loadavg)
  xdotool windowfocus --sync "$1" 2>/dev/null || true
  sleep "$busy"
  xdotool key Escape
  xdotool key ctrl+f
  sleep "$busy"
  xdotool type --delay 40 "$2"
  sleep "$busy"
  sleep 0.5
  xdotool key Escape
  sleep "$busy"
  xdotool key Return
}
ghostspace_windows() { xdotool search --onlyvisible --class '^GhostSpace$' 2>/dev/null | wc -l; }
titled() { xdotool search --onlyvisible --name "$1.*GhostSpace" >/dev/null 2>&1; }
page_is_there() { xdotool search --onlyvisible --name "$1" >/dev/null 2>&1; }
page_is_there_or_gone() { page_is_there "$1" || ! kill -0 "$2"; }
# Ends the browser and removes its profile. The next browser must find neither a window nor a profile in use.
close_browser() {
  kill "$browser" 2>/dev/null || true
  wait "$browser" 2>/dev/null || true
  rm -rf "$work/firefox" "$work/chromium" "$HOME/Downloads" "$XDG_CACHE_HOME/ghostspace"
}
no_window() { [ "$(ghostspace_windows)" = 0 ]; }

try() { # BROWSER SERVER URL TITLE_OF_PAGE LOG
  local name=$1-$2 log=$5 window
  : >"$work/calls"
  : >"$log"
  profile "$1"
  browse "$1" "$3"
  # The first start of a browser can take minutes on a busy machine. Wait for its page while it runs.
  if ! until_true 240 page_is_there_or_gone "$4" "$browser" || ! page_is_there "$4"; then
    import -window root "$pictures/$name-page.png"
    wrong "$name: the page does not show (see $pictures/$name-page.png)"
    close_browser
    return
  fi
  sleep 3
  window=$(xdotool search --onlyvisible --name "$4" | tail -1)
  import -window root "$pictures/$name-page.png"
  click_link "$window" "boat"
  if until_true 40 titled boat.qnv; then echo "ok: $name: a click on the link file opens the scene"; else wrong "$name: a click on the link file opens no scene"; fi
  sleep 2
  import -window root "$pictures/$name-click.png"
  verify "$name: one window" 1 "$(ghostspace_windows)"
  verify "$name: the program was given the link" 1 "$(grep -c 'gslink' "$work/calls")"
  verify "$name: the link was fetched once" 1 "$(grep -c 'GET /boat.qnv.gslink' "$log")"
  if grep -q 'GET /boat.qnv HTTP' "$log"; then echo "ok: $name: the stream was fetched"; else wrong "$name: the stream was not fetched"; fi
  if [ "$2" = nginx ]; then
    verify "$name: by nobody but GhostSpace" 0 "$(grep 'GET /boat.qnv HTTP' "$log" | grep -vc '"GhostSpace')"
    verify "$name: in parts, as it is looked at" 206 "$(sed -n 's/.*GET \/boat.qnv HTTP[^"]*" \([0-9]*\).*/\1/p' "$log" | head -1)"
    click_link "$window" "second"
    if until_true 40 titled 'A second scene'; then echo "ok: $name: a ghostspace: URL opens in the same window"; else wrong "$name: a ghostspace: URL opens nothing"; fi
    sleep 1
    import -window root "$pictures/$name-scheme.png"
    verify "$name: still one window" 1 "$(ghostspace_windows)"
  fi
  close_browser
  for window in $(xdotool search --onlyvisible --class '^GhostSpace$' 2>/dev/null); do
    xdotool windowfocus --sync "$window" key --window "$window" ctrl+q 2>/dev/null || true
  done
  until_true 10 no_window || wrong "$name: the window does not close"
}

tried=0
for browser_name in firefox-esr chromium; do
  if ! command -v $browser_name >/dev/null; then
    echo "skipped: $browser_name is not installed"
    continue
  fi
  tried=$((tried + 1))
  try $browser_name serve "$serve_url" '^site' "$work/serve.log"
  try $browser_name nginx "$nginx_url" 'Scenes' "$work/nginx/access.log"
done
echo "pictures: $pictures"
[ $failures -eq 0 ] && [ $tried -gt 0 ]
