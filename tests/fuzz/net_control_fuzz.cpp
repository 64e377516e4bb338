// Fuzzes the connections of control clients. Pieces of any size must give equal results. Memory must be bounded. No
// message may be processed before the token.
#include "net/control/control_connection.h"
#include "net/control/digest.h"
#include "tests/fuzz/net_targets.h"

#include <string>
#include <vector>

using namespace gs::net;

namespace gs::fuzz {
namespace {

constexpr std::size_t kMaxMessage = 2048;

struct Outcome {
  std::vector<std::string> messages;
  std::string out;
  bool admitted = false, closing = false;
  friend bool operator==(const Outcome&, const Outcome&) = default;
};

template <class Feed>
Outcome outcome(ControlProtocol protocol, const ControlTerms& terms, Feed&& feed) {
  ControlConnection connection(protocol, terms);
  Outcome result;
  feed([&](std::span<const std::byte> piece) {
    connection.receive(text_of(piece));
    for (std::string& message : connection.take_messages()) {
      require(connection.is_admitted());
      require(message.size() <= kMaxMessage);
      require(is_utf8(message));
      result.messages.push_back(std::move(message));
    }
    result.out += connection.outgoing();
    connection.sent(connection.outgoing().size());
  });
  result.admitted = connection.is_admitted();
  result.closing = connection.is_closing();
  return result;
}

}  // namespace

/// Fuzzes a control connection. The first line is "lines" or another word for a WebSocket; the rest are the client's
/// bytes. The token is "token".
bool run_control_client(std::span<const std::byte> bytes) {
  static const ControlTerms terms = [] {
    ControlTerms made;
    made.token = "token";
    made.limits.message_bytes = kMaxMessage;
    made.farewell = [](const std::string& why) { return why; };
    return made;
  }();
  const std::size_t end = text_of(bytes).find('\n');
  if (end == std::string_view::npos) return false;
  const ControlProtocol protocol =
      text_of(bytes.first(end)) == "lines" ? ControlProtocol::lines : ControlProtocol::web_socket;
  const auto rest = bytes.subspan(end + 1);
  const Outcome whole = outcome(protocol, terms, [&](const auto& push) { push(rest); });
  const Outcome cut = outcome(protocol, terms, [&](const auto& push) { in_pieces(rest, push); });
  require(whole == cut);
  return whole.admitted && !whole.messages.empty();
}

}  // namespace gs::fuzz
