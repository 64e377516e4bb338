#!/usr/bin/env bash
# Shows that Wireshark understands our cells: has tshark decode what a server of cells sends as ATM cells behind an
# MPLS label (RFC 7510, RFC 4717 N-to-one mode), and counts them by VPI and VCI.
#   scripts/check_cells.sh CAPTURE.pcap [PORT]    a capture; PORT if the server used another than 6635
#   scripts/check_cells.sh --hex FILE [PORT]      datagrams in the form of `od -Ax -tx1`, which text2pcap makes a capture of
#   scripts/check_cells.sh --live PORT SECONDS    captures on loopback (needs the right to capture)
# Fails if there were no cells, or if tshark found fault with one.
set -euo pipefail
label=1000
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
port=6635
case ${1:-} in
  --hex) port=${3:-$port}; capture=$folder/cells.pcap; text2pcap -q -u "$port,40000" "$2" "$capture" >/dev/null 2>&1 ;;
  --live) port=$2; capture=$folder/cells.pcap
    tshark -q -i lo -f "udp port $port" -a "duration:$3" -w "$capture" >/dev/null 2>&1 ;;
  '' | -h | --help) sed -n '2,7s/^# \?//p' "$0"; exit 2 ;;
  *) capture=$1; port=${2:-$port} ;;
esac
decode() { tshark -r "$capture" -d "udp.port==$port,mpls" -d "mpls.label==$label,mplspwatmn1cw" "$@" 2>/dev/null; }

echo "== the first datagrams"
decode -c 12
echo "== one of cells"
decode -Y 'atm.vci >= 64' -V | awk '/^Frame /{n++} n==1' |
  grep -E '^(User Datagram|MultiProtocol|MPLS PW ATM|PW Associated)|Sequence number' | head -12 || true
echo "== cells, by VPI/VCI"
decode -Y 'mplspwatmcell' -T fields -e atm.vpi -e atm.vci |
  awk -F'\t' '{ n = split($1, vpi, ","); split($2, vci, ","); for (i = 1; i <= n; i++) count[vpi[i] "/" vci[i]]++ }
              END { for (name in count) print name, count[name] }' | sort -V | tee "$folder/counts"
faults=$(decode -Y '_ws.malformed || atm.pti.invalid || (_ws.expert.severity == error)' | wc -l)
echo "== datagrams with faults: $faults"
[ -s "$folder/counts" ] && [ "$faults" -eq 0 ]
