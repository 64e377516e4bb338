// Fuzzes both ends of ssh: URLs: tunnels, and answers of SFTP servers. Pieces of any size must give equal results, and
// memory must be bounded.
#include "net/ssh/sftp_site.h"
#include "net/tunnel/tunnel_session.h"
#include "tests/fuzz/net_targets.h"

#include <string>
#include <tuple>
#include <vector>

using namespace gs::net;

namespace gs::fuzz {
namespace {

constexpr std::size_t kWindow = std::size_t{64} << 10;

using TunnelOutcome = std::tuple<std::string, std::vector<std::string>, bool>;

template <class Feed>
TunnelOutcome tunnel_outcome(TunnelRole role, Feed&& feed) {
  TunnelTerms terms;
  terms.role = role;
  TunnelSession session(terms, {});
  std::optional<std::string> problem;
  std::vector<Multiplexer::ConnectionId> all;
  if (role == TunnelRole::client)
    for (int i = 0; i < 3; ++i) all.push_back(session.open());
  feed([&](std::span<const std::byte> piece) {
    if (!problem) problem = session.receive(piece, {});
  });
  require(session.connections() <= terms.connections);
  for (const auto id : session.take_opened()) all.push_back(id);
  std::vector<std::string> received;
  for (const auto id : all) {
    require(session.received(id).size() <= kWindow);
    received.emplace_back(text_of(session.received(id)));
  }
  if (problem) require(problem->find_first_of("\n\x1b") == std::string::npos);
  return {problem.value_or(""), received, session.ready()};
}

std::pair<bool, std::string> sftp_outcome(std::span<const std::byte> bytes, bool in_parts) {
  SftpSite site({});
  const auto id = site.open();
  bool failed = false;
  const auto take = [&](std::span<const std::byte> piece) { failed = failed || site.receive(piece, {}).has_value(); };
  const std::string request = "GET /~/a.qnv HTTP/1.1\r\nRange: bytes=2-90\r\nGhostSpace-Within: /~/\r\n\r\n";
  site.send(id, std::as_bytes(std::span(request)));
  if (in_parts)
    in_pieces(bytes, take);
  else
    take(bytes);
  require(site.received(id).size() <= 70'000);
  require(site.outgoing().size() <= 200'000);
  return {failed, std::string(text_of(site.received(id)))};
}

}  // namespace

/// Fuzzes one end of a tunnel. The first byte is "c" for the client; the rest are the bytes of the other end.
bool run_tunnel(std::span<const std::byte> bytes) {
  if (bytes.empty()) return false;
  const TunnelRole role = bytes.front() == std::byte{'c'} ? TunnelRole::client : TunnelRole::server;
  const auto rest = bytes.subspan(1);
  const auto whole = tunnel_outcome(role, [&](const auto& push) { push(rest); });
  const auto cut = tunnel_outcome(role, [&](const auto& push) { in_pieces(rest, push); });
  require(whole == cut);
  return std::get<2>(whole) && std::get<0>(whole).empty();
}

/// Fuzzes the answers of an SFTP server to the request for a range of a file.
bool run_sftp(std::span<const std::byte> bytes) {
  const auto whole = sftp_outcome(bytes, false);
  require(whole == sftp_outcome(bytes, true));
  return !whole.first && !whole.second.empty();
}

}  // namespace gs::fuzz
