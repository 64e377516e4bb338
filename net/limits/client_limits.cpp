#include "net/limits/client_limits.h"

#include <algorithm>

namespace gs::net {
namespace {

constexpr std::uint64_t kRequest = 1000;  // tokens of one request in a client's bucket
constexpr std::size_t kLargestPiece = 65536;  // maximum bytes of a turn
constexpr std::size_t kSmallestPiece = 1460;  // minimum bytes of a turn: one TCP segment
constexpr std::uint64_t kTurnsPerSecond = 64;  // turns per second of a client that sends at its rate limit
constexpr std::size_t kMaxIdleClients = 4096;

}  // namespace

ClientKey client_key(const IpAddress& address) {
  static const AddressBlock four = *address_block_of("0.0.0.0/0");
  ClientKey key{};
  if (four.contains(address))
    std::copy(address.end() - 4, address.end(), key.end() - 4);
  else
    std::copy_n(address.begin(), 8, key.begin());
  return key;
}

ClientKey client_key(const sockaddr* address) {
  const auto known = address ? ip_address_of(address) : std::nullopt;
  return known ? client_key(*known) : ClientKey{};
}

std::string client_name(const sockaddr* address) {
  const auto known = address ? ip_address_of(address) : std::nullopt;
  return known ? address_text(*known) : "-";
}

ClientLimits::ClientLimits(HttpLimits limits, Instant now) : limits_(limits) {
  const std::uint64_t slowest = std::min(limits_.total_rate > 0 ? limits_.total_rate : UINT64_MAX,
                                         limits_.client_rate > 0 ? limits_.client_rate : UINT64_MAX);
  piece_ =
      static_cast<std::size_t>(std::clamp<std::uint64_t>(slowest / kTurnsPerSecond, kSmallestPiece, kLargestPiece));
  total_ = TokenBucket(limits_.total_rate, 2 * piece_, now);
}

ClientLimits::Client& ClientLimits::client(const ClientKey& key, Instant now) {
  const auto [found, is_new] = clients_.try_emplace(key);
  Client& client = found->second;
  if (is_new) {
    client.bytes = TokenBucket(limits_.client_rate, 2 * piece_, now);
    client.requests =
        TokenBucket(limits_.requests_per_second * kRequest, 2 * limits_.requests_per_second * kRequest, now);
  }
  client.seen = now;
  return client;
}

// Removes idle clients if there are too many. Others remain, because their request buckets must not refill early.
void ClientLimits::forget(Instant now) {
  constexpr Instant kLong{10'000'000};
  if (clients_.size() < kMaxIdleClients) return;
  std::erase_if(clients_, [&](const auto& entry) {
    return entry.second.connections == 0 && entry.second.waiting.empty() && now - entry.second.seen > kLong;
  });
  if (clients_.size() < 4 * kMaxIdleClients) return;
  std::erase_if(clients_,
                [](const auto& entry) { return entry.second.connections == 0 && entry.second.waiting.empty(); });
}

bool ClientLimits::open(const ClientKey& peer, bool shared, Instant now) {
  if (limits_.connections > 0 && connections_ >= limits_.connections) return false;
  if (!shared && !begin(peer, now)) return false;
  ++connections_;
  return true;
}

void ClientLimits::close(const ClientKey& peer, bool shared, Instant now) {
  if (!shared) end(peer, now);
  if (connections_ > 0) --connections_;
}

bool ClientLimits::begin(const ClientKey& key, Instant now) {
  forget(now);
  Client& one = client(key, now);
  if (limits_.connections_of_client > 0 && one.connections >= limits_.connections_of_client) return false;
  ++one.connections;
  return true;
}

void ClientLimits::end(const ClientKey& key, Instant now) {
  Client& one = client(key, now);
  if (one.connections > 0) --one.connections;
}

bool ClientLimits::admit(const ClientKey& key, Instant now) {
  if (limits_.requests_per_second == 0) return true;
  Client& one = client(key, now);
  if (!one.requests.has(kRequest, now)) return false;
  one.requests.take(kRequest, now);
  return true;
}

void ClientLimits::wait(const ClientKey& key, TransferId transfer, Instant now) {
  Client& one = client(key, now);
  if (one.waiting.empty()) turns_.push_back(key);
  one.waiting.push_back(transfer);
}

std::optional<ClientLimits::TransferId> ClientLimits::next(Instant now) {
  if (limits_.total_rate > 0 && !total_.has(piece_, now)) return std::nullopt;
  for (std::size_t i = 0; i < turns_.size(); ++i) {
    const ClientKey key = turns_.front();
    turns_.pop_front();
    Client& one = clients_[key];
    if (limits_.client_rate > 0 && !one.bytes.has(piece_, now)) {
      turns_.push_back(key);
      continue;
    }
    const TransferId transfer = one.waiting.front();
    one.waiting.pop_front();
    if (!one.waiting.empty()) turns_.push_back(key);
    if (limits_.total_rate > 0) total_.take(piece_, now);
    if (limits_.client_rate > 0) one.bytes.take(piece_, now);
    return transfer;
  }
  return std::nullopt;
}

Instant ClientLimits::deadline(Instant now) {
  if (turns_.empty()) return Instant::max();
  const Instant total = limits_.total_rate > 0 ? total_.when(piece_, now) : now;
  if (limits_.client_rate == 0) return total;
  Instant first = Instant::max();
  for (const ClientKey& key : turns_) first = std::min(first, clients_[key].bytes.when(piece_, now));
  return std::max(total, first);
}

}  // namespace gs::net
