#include "net/cells/cell_sender.h"

#include <algorithm>
#include <string>
#include <variant>

namespace gs::net {
namespace {

constexpr std::size_t kMaxAnswers = 1024;
constexpr Instant kCookieLife{60'000'000};
constexpr std::uint64_t kOpensPerSecond = 4, kOpensAtOnce = kMaxSlots;
constexpr std::size_t kMaxBase = ErasureLayout::kMaxBytes;

std::uint64_t server_burst_of(std::uint64_t rate) { return std::max<std::uint64_t>(4 * kMaxDatagram, rate / 500); }

}  // namespace

CellServer::CellServer(CellServerOptions options, std::shared_ptr<CellLibrary> library)
    : options_(std::move(options)),
      library_(std::move(library)),
      cookies_(options_.secret),
      total_(options_.total_rate / 8, server_burst_of(options_.total_rate / 8), Instant{}) {}

void CellServer::receive(const Endpoint& from, std::span<const std::byte> bytes, Instant now) {
  const auto message = decode_contract(bytes);
  if (!message) {
    ++statistics_.foreign;
    return;
  }
  if (const auto* hello = std::get_if<HelloMessage>(&*message)) {
    if (bytes.size() >= kHelloBytes) answer(from, cookies_.make(from, hello->nonce, now));
  } else if (const auto* request = std::get_if<RequestMessage>(&*message)) {
    handle_request(from, *request, now);
  } else if (const auto* report = std::get_if<ReportMessage>(&*message)) {
    const auto found = sessions_.find(from);
    if (found == sessions_.end() || found->second->id() != report->session)
      return answer(from, ByeMessage{report->session, ""});  // shorter than a report: no amplification
    const std::uint64_t wanted = found->second->wanted();
    const bool silent = found->second->silent(now);
    found->second->report(*report, now);
    if (found->second->wanted() != wanted || silent) divide(now);
  } else if (const auto* bye = std::get_if<ByeMessage>(&*message)) {
    const auto found = sessions_.find(from);
    if (found == sessions_.end() || found->second->id() != bye->session) return;
    sessions_.erase(found);
    opens_.erase(from);
    divide(now);
  } else {
    ++statistics_.foreign;
  }
}

void CellServer::answer(const Endpoint& to, const ContractMessage& message) {
  if (answers_.size() < kMaxAnswers) answers_.push_back({to, encode_contract(message)});
}

void CellServer::refuse(const Endpoint& to, const RequestMessage& request, Refusal why, std::string text) {
  ++statistics_.refused;
  answer(to, RefuseMessage{request.cookie.nonce, request.number, request.slot, why, std::move(text)});
}

void CellServer::handle_request(const Endpoint& from, const RequestMessage& request, Instant now) {
  const auto age = cookies_.age(request.cookie, from, now);
  if (!age) return;  // this server did not make the cookie: do not answer, because the address may be forged
  CellSession* session = session_for(from, request, *age, now);
  if (!session) return;
  const std::uint32_t known = session->number(request.slot);
  if (request.number < known || request.number == 0) return;
  if (request.number > known) {
    TokenBucket& opens = opens_.try_emplace(from, kOpensPerSecond, kOpensAtOnce, now).first->second;
    if (!opens.has(1, now)) return;  // too many new sessions; the client will repeat its request
    opens.take(1, now);
    session->set_wanted(request.rate / 8);
    divide(now);
    open(from, *session, request);
  }
  if (session->number(request.slot) == request.number) answer(from, session->answer(request.slot));
}

CellSession* CellServer::session_for(const Endpoint& from, const RequestMessage& request, Instant age, Instant now) {
  const auto found = sessions_.find(from);
  if (found != sessions_.end() && found->second->nonce() == request.cookie.nonce) return found->second.get();
  if (age > kCookieLife) {
    answer(from, cookies_.make(from, request.cookie.nonce, now));
    return nullptr;
  }
  forget(now);
  if (found == sessions_.end()) {
    const auto same = std::count_if(sessions_.begin(), sessions_.end(),
                                    [&](const auto& entry) { return entry.first.address == from.address; });
    if (sessions_.size() >= options_.most_clients || static_cast<std::size_t>(same) >= options_.most_of_address) {
      refuse(from, request, Refusal::full, "the server has its maximum number of clients; try again later");
      return nullptr;
    }
  }
  ++statistics_.accepted;
  auto& place = sessions_[from];
  // The age of the cookie is one round trip plus the client's reaction time. So the age bounds the round trip.
  place = std::make_unique<CellSession>(options_.session, cookies_.session(from, request.cookie.nonce),
                                        request.cookie.nonce, age, now);
  return place.get();
}

void CellServer::open(const Endpoint& from, CellSession& session, const RequestMessage& request) {
  if (request.path.empty()) return session.set(request, nullptr, nullptr);
  auto opened = library_->open(request.path);
  if (auto* text = std::get_if<std::string>(&opened))
    return refuse(from, request, Refusal::not_found, std::move(*text));
  auto source = std::move(std::get<std::shared_ptr<CellSource>>(opened));
  if (!source || source->base().empty() || source->base().size() > kMaxBase)
    return refuse(from, request, Refusal::not_found, "the source has no base to send");
  auto base = encoder(source, request.cells);
  session.set(request, std::move(source), std::move(base));
}

/// Returns the erasure encoder of a source's base. Clients of one source share it.
std::shared_ptr<const ErasureEncoder> CellServer::encoder(const std::shared_ptr<CellSource>& source,
                                                          std::size_t cells) {
  std::erase_if(encoders_, [](const auto& entry) { return entry.second.encoder.expired(); });
  Shared& shared = encoders_[{source.get(), cells}];
  if (auto known = shared.encoder.lock(); known && shared.source.lock() == source) return known;
  const auto base = source->base();
  const std::size_t symbol = std::clamp<std::size_t>(base.size(), 8, piece_bytes(cells));
  auto made = std::make_shared<const ErasureEncoder>(base, erasure_layout(base.size(), symbol));
  shared = {source, made};
  return made;
}

/// Divides the total rate among clients (max-min fairness). A client gets its requested rate, or an equal share if the
/// total is too low.
void CellServer::divide(Instant now) {
  std::vector<std::pair<std::uint64_t, CellSession*>> wants;
  for (const auto& [endpoint, session] : sessions_)
    wants.emplace_back(session->silent(now) ? 0 : std::min(session->wanted(), options_.client_rate / 8), session.get());
  std::sort(wants.begin(), wants.end());
  std::uint64_t left = options_.total_rate / 8;
  for (std::size_t i = 0; i < wants.size(); ++i) {
    const std::uint64_t granted = std::min(wants[i].first, left / (wants.size() - i));
    left -= granted;
    if (wants[i].second->granted() != granted) wants[i].second->grant(granted, now);
  }
}

void CellServer::forget(Instant now) {
  const auto gone =
      std::erase_if(sessions_, [&](const auto& entry) { return now >= entry.second->last_heard() + options_.forget; });
  if (gone == 0) return;
  std::erase_if(opens_, [&](const auto& entry) { return !sessions_.contains(entry.first); });
  divide(now);
}

std::optional<OutgoingDatagram> CellServer::next(Instant now) {
  std::optional<OutgoingDatagram> result;
  if (!answers_.empty()) {
    result = std::move(answers_.front());
    answers_.pop_front();
  }
  for (auto it = sessions_.begin(); !result && it != sessions_.end(); ++it) {
    if (it->second->sync_due(now) > now) continue;
    result = {it->first, encode_contract(it->second->sync(now))};
    // A grant may be lost. Repeat it with each sync message until a report of the client mentions the slot.
    for (std::size_t slot = 0; slot < kMaxSlots; ++slot)
      if (it->second->unknown(slot)) answer(it->first, it->second->answer(slot));
  }
  if (!result && total_.has(kMaxDatagram + kPacketHeaders, now)) {
    // Serve clients in turn, beginning after the client that was served last.
    auto it = sessions_.upper_bound(turn_);
    for (std::size_t i = 0; i < sessions_.size() && !result; ++i, ++it) {
      if (it == sessions_.end()) it = sessions_.begin();
      if (it->second->ready(now) > now) continue;
      auto made = it->second->datagram(now);
      if (made.bytes.empty()) continue;
      total_.take(made.bytes.size() + kPacketHeaders, now);
      if (made.parity) {
        ++statistics_.parity_datagrams;
        statistics_.parity_bytes += made.bytes.size();
      }
      turn_ = it->first;
      result = {it->first, std::move(made.bytes)};
    }
  }
  if (!result) return std::nullopt;
  ++statistics_.datagrams;
  statistics_.bytes += result->bytes.size();
  return result;
}

Instant CellServer::deadline(Instant now) {
  if (!answers_.empty()) return now;
  forget(now);
  Instant first = Instant::max();
  const Instant total = total_.when(kMaxDatagram + kPacketHeaders, now);
  for (const auto& [endpoint, session] : sessions_) {
    first = std::min({first, session->sync_due(now), session->last_heard() + options_.forget});
    const Instant ready = session->ready(now);
    if (ready != Instant::max()) first = std::min(first, std::max(ready, total));
  }
  return std::max(first, now);
}

void CellServer::stop() {
  for (const auto& [endpoint, session] : sessions_)
    answer(endpoint, ByeMessage{session->id(), "the server is stopping"});
  sessions_.clear();
  opens_.clear();
}

CellServerStatistics CellServer::statistics() const {
  CellServerStatistics result = statistics_;
  result.clients = sessions_.size();
  return result;
}

}  // namespace gs::net
