#!/usr/bin/env bash
# Checks that Wireshark decodes our cells. tshark decodes datagrams of a cell server as ATM cells after an MPLS label
# (RFC 7510, RFC 4717 N-to-one mode). Prints the number of cells by VPI and VCI.
#   scripts/checks/check_cells.sh CAPTURE.pcap [PORT]    a capture; PORT if the server does not use 6635
#   scripts/checks/check_cells.sh --hex FILE [PORT]      datagrams in the format of `od -Ax -tx1`; text2pcap converts them
#   scripts/checks/check_cells.sh --live PORT SECONDS    captures on loopback (needs the permission to capture)
# Fails if there are no cells, or if tshark reports an error in one.
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
