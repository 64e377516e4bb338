#include "net/tunnel/tunnel_session.h"

#include <algorithm>
#include <utility>

namespace gs::net {
namespace {

/// Bytes that may be sent on a new connection, and limits of the window.
constexpr std::size_t kFirstWindow = std::size_t{64} << 10, kMaxWindow = std::size_t{8} << 20;
/// Maximum data in one frame. Small frames let connections take turns.
constexpr std::size_t kDataFrame = std::size_t{16} << 10;
/// Bytes that wait for the pipe before no more data is accepted. Fewer bytes let urgent connections overtake sooner.
constexpr std::size_t kMaxWaiting = std::size_t{64} << 10;
/// Bytes that wait for the pipe before the other end counts as hostile: it makes this end answer, but reads nothing.
constexpr std::size_t kMaxUnread = std::size_t{4} << 20;
constexpr std::uint64_t kMaxCredit = std::uint64_t{1} << 31;
constexpr std::size_t kMaxPing = 64;
/// Factor by which the rate must grow before the window grows.
constexpr double kFaster = 1.1;

std::string text_of_payload(std::span<const std::byte> payload) {
  std::string text(reinterpret_cast<const char*>(payload.data()), std::min<std::size_t>(payload.size(), 200));
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  return text;
}

}  // namespace

TunnelSession::TunnelSession(TunnelTerms terms, Time now)
    : terms_(std::move(terms)), window_(kFirstWindow), heard_(now) {
  const auto mark = std::as_bytes(std::span(kTunnelMark));
  out_.assign(mark.begin(), mark.end());
  append_frame(out_, TunnelFrameKind::hello, 0,
               std::string_view(hello_text({{kTunnelProtocol}, terms_.version, {"http"}})));
}

std::span<const std::byte> TunnelSession::outgoing() const { return std::span(out_).subspan(out_begin_); }

void TunnelSession::sent(std::size_t bytes) {
  out_begin_ += bytes;
  if (out_begin_ < out_.size() / 2) return;
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(out_begin_));
  out_begin_ = 0;
}

std::optional<std::string> TunnelSession::receive(std::span<const std::byte> bytes, Time now) {
  if (!bytes.empty()) heard_ = now;
  // In pieces, so that the reader never holds more than one frame and a piece.
  while (!bytes.empty()) {
    const auto piece = bytes.first(std::min(bytes.size(), kMaxTunnelPayload));
    bytes = bytes.subspan(piece.size());
    if (auto problem = reader_.receive(piece)) return problem;
    while (const auto frame = reader_.next())
      if (auto problem = take(*frame, now)) return problem;
    // The frame after the last complete one may have an invalid length.
    if (auto problem = reader_.receive({})) return problem;
  }
  return std::nullopt;
}

std::optional<std::string> TunnelSession::take(const TunnelFrame& frame, Time now) {
  if (frame.kind == TunnelFrameKind::error && frame.connection == 0)
    return "it reports: " + text_of_payload(frame.payload);
  if (frame.kind == TunnelFrameKind::hello) return take_hello(frame);
  if (!hello_) return "it sends a frame before its hello";
  switch (frame.kind) {
    case TunnelFrameKind::ping:
      if (frame.payload.size() > kMaxPing)
        return "it sends a ping of " + std::to_string(frame.payload.size()) + " bytes";
      if (outgoing().size() > kMaxUnread) return "it does not read the answers to its pings";
      append_frame(out_, TunnelFrameKind::pong, 0, frame.payload);
      return std::nullopt;
    case TunnelFrameKind::pong:
      take_pong(frame, now);
      return std::nullopt;
    case TunnelFrameKind::open:
    case TunnelFrameKind::data:
    case TunnelFrameKind::window:
    case TunnelFrameKind::close:
    case TunnelFrameKind::error:
      return take_of_connection(frame, now);
    default:
      return std::nullopt;  // of a later version
  }
}

std::optional<std::string> TunnelSession::take_hello(const TunnelFrame& frame) {
  if (hello_) return "it sends two hellos";
  TunnelHello hello = parse_hello({reinterpret_cast<const char*>(frame.payload.data()), frame.payload.size()});
  if (std::find(hello.protocols.begin(), hello.protocols.end(), kTunnelProtocol) == hello.protocols.end())
    return "its version " + text_of_payload(std::as_bytes(std::span(hello.version))) +
           " does not speak the protocol of this version (" + std::to_string(kTunnelProtocol) + ")";
  hello_ = std::move(hello);
  return std::nullopt;
}

std::optional<std::string> TunnelSession::take_of_connection(const TunnelFrame& frame, Time now) {
  const ConnectionId id = frame.connection;
  if (frame.kind == TunnelFrameKind::open) {
    if (terms_.role == TunnelRole::client) return "it opens a connection, which only a client may do";
    if (id <= last_id_) return "it opens connection " + std::to_string(id) + " twice";
    last_id_ = id;
    if (outgoing().size() > kMaxUnread) return "it does not read the refusals of its connections";
    if (connections_.size() >= terms_.connections) {
      append_frame(out_, TunnelFrameKind::error, id, std::string_view("too many connections"));
      return std::nullopt;
    }
    Connection& connection = connections_[id];
    connection.send_credit = connection.receive_credit = kFirstWindow;
    opened_.push_back(id);
    return std::nullopt;
  }
  if (id == 0 || id > last_id_) return "it uses connection " + std::to_string(id) + ", which does not exist";
  const auto found = connections_.find(id);
  if (found == connections_.end()) return std::nullopt;  // closed here, and the other end did not know yet
  Connection& connection = found->second;
  if (frame.kind == TunnelFrameKind::window) {
    const auto credit = number_of(frame);
    if (!credit || connection.send_credit + *credit > kMaxCredit) return "it grants an invalid window";
    connection.send_credit += *credit;
  } else if (frame.kind == TunnelFrameKind::data) {
    if (connection.peer_ended) return "it sends data of a closed connection";
    if (frame.payload.size() > connection.receive_credit) return "it sends more data than the window allows";
    connection.receive_credit -= frame.payload.size();
    connection.in.insert(connection.in.end(), frame.payload.begin(), frame.payload.end());
    measure(frame.payload.size(), now);
  } else {
    connection.peer_ended = true;
    if (frame.kind == TunnelFrameKind::error) {
      connection.in.clear();
      connection.in_begin = 0;
    }
  }
  return std::nullopt;
}

/// Measures the rate of received data between a ping and its pong. Twice the bytes of that time fill the line, unless a
/// larger window only made its queues longer: then the rate does not grow.
void TunnelSession::measure(std::size_t bytes, Time now) {
  if (terms_.role != TunnelRole::client) return;
  if (!pinged_) ping(now);
  probed_bytes_ += bytes;
}

void TunnelSession::take_pong(const TunnelFrame& frame, Time now) {
  if (!pinged_ || number_of(frame) != last_ping_) return;
  const double seconds = std::max(1e-6, std::chrono::duration<double>(now - *pinged_).count());
  pinged_.reset();
  const double rate = static_cast<double>(probed_bytes_) / seconds;
  if (probed_bytes_ * 3 >= window_ * 2 && rate > best_rate_ * kFaster) {
    best_rate_ = rate;
    window_ = std::min<std::size_t>(kMaxWindow, std::max<std::size_t>(window_ * 2, 2 * probed_bytes_));
    for (auto& [id, connection] : connections_) grant(id, connection);
  }
}

void TunnelSession::ping(Time now) {
  pinged_ = now;
  probed_bytes_ = 0;
  append_frame(out_, TunnelFrameKind::ping, 0, ++last_ping_);
}

void TunnelSession::grant(ConnectionId id, Connection& connection) {
  const std::uint64_t held = connection.receive_credit + (connection.in.size() - connection.in_begin);
  if (connection.peer_ended || held + window_ / 4 > window_) return;
  append_frame(out_, TunnelFrameKind::window, id, static_cast<std::uint32_t>(window_ - held));
  connection.receive_credit += window_ - held;
}

std::optional<std::string> TunnelSession::step(Time now) {
  if (!hello_) return std::nullopt;  // ssh may still ask the user
  if (pinged_ && now >= std::max(heard_, *pinged_) + terms_.quiet)
    return "no answer for " + std::to_string(std::chrono::duration_cast<std::chrono::seconds>(now - heard_).count()) +
           " s";
  if (!pinged_ && now >= heard_ + terms_.quiet) ping(now);
  return std::nullopt;
}

std::optional<Multiplexer::Time> TunnelSession::deadline() const {
  if (!hello_) return std::nullopt;
  return (pinged_ ? std::max(heard_, *pinged_) : heard_) + terms_.quiet;
}

Multiplexer::ConnectionId TunnelSession::open() {
  if (connections_.size() >= terms_.connections) return 0;
  const ConnectionId id = ++last_id_;
  Connection& connection = connections_[id];
  connection.send_credit = connection.receive_credit = kFirstWindow;
  append_frame(out_, TunnelFrameKind::open, id);
  grant(id, connection);
  return id;
}

std::size_t TunnelSession::room(ConnectionId id) const {
  const auto found = connections_.find(id);
  if (found == connections_.end() || outgoing().size() >= kMaxWaiting) return 0;
  return static_cast<std::size_t>(std::min<std::uint64_t>(kDataFrame, found->second.send_credit));
}

void TunnelSession::send(ConnectionId id, std::span<const std::byte> bytes) {
  const auto found = connections_.find(id);
  if (found == connections_.end()) return;
  found->second.send_credit -= std::min<std::uint64_t>(bytes.size(), found->second.send_credit);
  append_frame(out_, TunnelFrameKind::data, id, bytes);
}

std::span<const std::byte> TunnelSession::received(ConnectionId id) const {
  const auto found = connections_.find(id);
  return found == connections_.end() ? std::span<const std::byte>()
                                     : std::span(found->second.in).subspan(found->second.in_begin);
}

void TunnelSession::took(ConnectionId id, std::size_t bytes) {
  const auto found = connections_.find(id);
  if (found == connections_.end()) return;
  Connection& connection = found->second;
  connection.in_begin += bytes;
  if (connection.in_begin >= connection.in.size() / 2) {
    connection.in.erase(connection.in.begin(),
                        connection.in.begin() + static_cast<std::ptrdiff_t>(connection.in_begin));
    connection.in_begin = 0;
  }
  grant(id, connection);
}

bool TunnelSession::ended(ConnectionId id) const {
  const auto found = connections_.find(id);
  return found == connections_.end() || found->second.peer_ended;
}

void TunnelSession::close(ConnectionId id) {
  if (connections_.erase(id) > 0) append_frame(out_, TunnelFrameKind::close, id);
}

std::vector<Multiplexer::ConnectionId> TunnelSession::take_opened() { return std::exchange(opened_, {}); }

}  // namespace gs::net
