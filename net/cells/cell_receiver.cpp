#include "net/cells/cell_receiver.h"

#include <algorithm>
#include <utility>
#include <variant>

namespace gs::net {
namespace {

constexpr Instant kReportAtLeastEvery{200'000}, kReportAtMostEvery{20'000}, kLongestBackoff{2'000'000};
constexpr std::size_t kRepairs = 64;  // maximum lost chunks that one report requests again
constexpr std::size_t kMaxNamed = kMaxWishes;  // maximum runs of chunks in a report; fits one datagram
constexpr std::size_t kMaxEarly = 128;
constexpr std::uint64_t kFarAhead = 16384;

Instant backed_off(Instant first, std::size_t tries) {
  constexpr std::size_t kQuick = 8;
  return std::min(first * (1 << (std::clamp<std::size_t>(tries, kQuick, kQuick + 6) - kQuick)), kLongestBackoff);
}

}  // namespace

CellClient::CellClient(CellClientOptions options) : options_(options), nonce_(options.nonce) {}

void CellClient::begin(Instant now) {
  phase_ = Phase::hello;
  cookie_.reset();
  session_ = 0;
  tries_ = 0;
  hello_at_ = heard_ = now;
  history_ = {};
  rebuilder_ = {};
  delay_ = {};
  early_.clear();
  sync_next_ = 0;
  echo_ = 0;
  report_number_ = 0;
  for (Slot& slot : slots_) {
    if (slot.state == Slot::State::granted) slot.state = Slot::State::asking;
    slot.ask = now;
    slot.tries = 0;
  }
}

void CellClient::fail(std::string text) {
  phase_ = Phase::over;
  CellEvent event;
  event.text = std::move(text);
  events_.push_back(std::move(event));
}

void CellClient::want(std::size_t number, CellWish wish, Instant now) {
  if (number >= kMaxSlots || phase_ == Phase::over) return;
  Slot& slot = slots_[number];
  if (wish.path != slot.wish.path) slot.assembly.reset();
  wish.cells = static_cast<std::uint8_t>(std::clamp<std::size_t>(wish.cells, kMinCells, kMaxCells));
  slot.wish = std::move(wish);
  slot.number = ++request_number_;
  slot.state = Slot::State::asking;
  slot.ask = now;
  slot.tries = 0;
  slot.ended = slot.complete = false;
  if (phase_ == Phase::idle) begin(now);
}

void CellClient::prefer(std::size_t number, std::vector<Region> regions, std::vector<ChunkName> chunks) {
  if (number >= kMaxSlots) return;
  regions.resize(std::min(regions.size(), kMaxRegions));
  chunks.resize(std::min(chunks.size(), kMostPreferred));
  slots_[number].regions = std::move(regions);
  slots_[number].chunks = std::move(chunks);
  report_now_ = true;
}

void CellClient::forget(std::size_t number, std::span<const ChunkName> chunks) {
  if (number >= kMaxSlots || !slots_[number].assembly) return;
  for (const ChunkName& name : chunks) slots_[number].assembly->forget(name);
}

// Returns the preferred chunks that were not received, else lost ones to repair, as at most `most` runs.
std::vector<ChunkRun> CellClient::wishes_of(Slot& slot, std::size_t most) {
  std::erase_if(slot.chunks, [&](const ChunkName& name) { return slot.assembly->has(name); });
  const bool repairs = slot.ended && slot.wish.repair && slot.chunks.empty();
  const std::vector<ChunkName> lost =
      repairs ? slot.assembly->missing(slot.wish.streams, kRepairs) : std::vector<ChunkName>();
  std::vector<ChunkRun> runs;
  for (const ChunkName& name : repairs ? lost : slot.chunks) {
    ChunkRun* const last = runs.empty() ? nullptr : &runs.back();
    if (last && last->first.stream == name.stream && last->first.chunk + last->count == name.chunk &&
        last->count < ChunkRun::kMost) {
      ++last->count;
      continue;
    }
    if (runs.size() >= most) break;
    runs.push_back({name, 1});
  }
  return runs;
}

void CellClient::bye(Instant) {
  if (session_ != 0) outbox_.push_back(encode_contract(ByeMessage{session_, ""}));
  phase_ = Phase::over;
  for (Slot& slot : slots_) slot = {};
}

bool CellClient::anything_wanted() const {
  return std::any_of(slots_.begin(), slots_.end(), [](const Slot& slot) { return slot.state != Slot::State::empty; });
}

void CellClient::receive(std::span<const std::byte> bytes, Instant now) {
  if (phase_ == Phase::idle || phase_ == Phase::over) return;
  if (auto message = decode_contract(bytes)) {
    if (const auto* cookie = std::get_if<CookieMessage>(&*message)) {
      if (cookie->nonce != nonce_) return;
      heard_ = now;
      cookie_ = *cookie;
      phase_ = Phase::active;
    } else if (const auto* grant = std::get_if<GrantMessage>(&*message)) {
      handle_grant(*grant, now);
    } else if (const auto* refusal = std::get_if<RefuseMessage>(&*message)) {
      handle_refusal(*refusal);
    } else if (const auto* sync = std::get_if<SyncMessage>(&*message)) {
      handle_sync(*sync, now);
    } else if (const auto* bye = std::get_if<ByeMessage>(&*message)) {
      handle_bye(*bye, now);
    } else {
      ++statistics_.foreign;
    }
  } else {
    handle_datagram(bytes, now);
  }
}

void CellClient::handle_datagram(std::span<const std::byte> bytes, Instant now) {
  const auto decoded = decode_datagram(bytes);
  const auto* datagram = std::get_if<CellDatagram>(&decoded);
  if (!datagram || datagram->label != kCellLabel || datagram->sequence == 0)
    ++statistics_.foreign;
  else if (session_ != 0)
    handle_cells(*datagram, bytes, now);
  else if (cookie_ && early_.size() < kMaxEarly && bytes.size() <= kMaxDatagram)
    early_.push_back({{bytes.begin(), bytes.end()}, now});
}

void CellClient::append(std::vector<CellEvent> made) {
  for (CellEvent& event : made) {
    waiting_ += event.bytes.size() + event.head.size();
    events_.push_back(std::move(event));
  }
}

void CellClient::handle_grant(const GrantMessage& grant, Instant now) {
  Slot& slot = slots_[grant.slot];
  if (slot.state != Slot::State::asking || slot.number != grant.number || grant.session == 0) return;
  heard_ = now;
  known_ = true;
  if (session_ == 0) {
    session_ = grant.session;
    report_at_ = now;
    (void)history_.measure_receive_rate(now);
  }
  delay_aware_ = grant.delay_aware;
  statistics_.granted = grant.rate;
  if (slot.wish.path.empty()) {
    slot = Slot{};
    return;
  }
  slot.state = Slot::State::granted;
  // Keep received data if the content is the same, for example after a new budget or after contact was lost.
  if (!slot.assembly || !slot.assembly->continues(grant))
    slot.assembly = std::make_unique<CellAssembly>(grant.slot, grant);
  CellEvent event;
  event.kind = CellEvent::Kind::granted;
  event.slot = grant.slot;
  event.version = grant.version;
  event.rate = grant.rate;
  for (const StreamGrant& stream : grant.streams) event.chunks.push_back(stream.chunks);
  events_.push_back(std::move(event));
  for (const Early& early : std::exchange(early_, {})) handle_datagram(early.bytes, early.at);
}

void CellClient::handle_refusal(const RefuseMessage& refusal) {
  Slot& slot = slots_[refusal.slot];
  if (refusal.nonce != nonce_ || slot.state != Slot::State::asking || slot.number != refusal.number) return;
  slot = Slot{};
  CellEvent event;
  event.kind = CellEvent::Kind::refused;
  event.slot = refusal.slot;
  event.text = refusal.text;
  events_.push_back(std::move(event));
}

void CellClient::handle_sync(const SyncMessage& sync, Instant now) {
  if (session_ == 0 || sync.session != session_) return;
  heard_ = now;
  stamp(sync.time, now);
  sync_next_ = std::max(sync_next_, sync.next);
  round_trip_ = std::clamp(Instant(sync.round_trip), Instant(500), kLongestBackoff);
  statistics_.granted = sync.granted;
  statistics_.server_rate = sync.rate;
  for (const SlotSync& said : sync.slots) {
    Slot& slot = slots_[said.slot];
    if (slot.state != Slot::State::granted || slot.number != said.number) continue;
    if (said.ended && !slot.ended) {
      CellEvent event;
      event.kind = CellEvent::Kind::ended;
      event.slot = said.slot;
      std::vector<CellEvent> made;
      slot.assembly->gap(made);
      made.push_back(std::move(event));
      append(std::move(made));
    }
    slot.ended = said.ended;
    tell_complete(said.slot);
  }
}

// Reports `complete` to the owner, once per request.
void CellClient::tell_complete(std::size_t number) {
  Slot& slot = slots_[number];
  if (!slot.ended || slot.complete || !slot.assembly->base_done()) return;
  slot.complete = slot.assembly->missing(slot.wish.streams, 1).empty();
  if (!slot.complete) return;
  CellEvent event;
  event.kind = CellEvent::Kind::complete;
  event.slot = static_cast<std::uint8_t>(number);
  events_.push_back(std::move(event));
}

void CellClient::handle_bye(const ByeMessage& bye, Instant now) {
  if (session_ == 0 || bye.session != session_) return;
  if (!bye.text.empty()) return fail("the server ended the session: " + bye.text);
  // The server has forgotten this client; start again.
  ++nonce_;
  begin(now);
}

void CellClient::stamp(std::uint32_t time, Instant now) {
  echo_ = time == 0 ? 1 : time;  // 0 means that no time stamp was received
  echo_at_ = now;
}

void CellClient::handle_cells(const CellDatagram& datagram, std::span<const std::byte> bytes, Instant now) {
  heard_ = now;
  if (waiting_ > options_.most_waiting) {
    // The owner is slow. The dropped datagrams count as lost, so the server slows down.
    ++statistics_.refused_for_space;
    return;
  }
  cells_at_ = now;
  std::uint64_t expected = history_.next();
  if (sync_next_ > expected + kFarAhead) expected = sync_next_;
  const std::uint64_t number = widen_sequence(datagram.sequence, expected);
  const bool gap = number > history_.next();
  const bool parity = CellRebuilder::is_parity(datagram.cells);
  assemble(parity ? std::span<const Cell>{} : datagram.cells, gap, now);
  std::vector<CellRebuilder::Rebuilt> rebuilt;
  if (parity) {
    ++statistics_.parity;
    if (const auto head = rebuilder_.add_parity(number, datagram.cells, rebuilt)) {
      delay_.add(head->time, static_cast<std::uint32_t>(now.count()));
      stamp(head->time, now);
    }
  } else if (!datagram.cells.empty() && datagram.cells[0].vc.vci != kBaseVci) {
    rebuilder_.add(number, bytes.subspan(kDatagramHeader), rebuilt);
  }
  handle_rebuilt(rebuilt);
  history_.arrived(number, bytes.size() + kPacketHeaders, now, round_trip_, !delay_aware_ || delay_.queued());
  if (history_.clear_new_event()) report_now_ = true;
  ++statistics_.datagrams;
  statistics_.bytes += bytes.size();
}

/// Passes the cells of one datagram to all slots. `gap` means that datagrams directly before it are missing.
void CellClient::assemble(std::span<const Cell> cells, bool gap, Instant now) {
  for (std::size_t i = 0; i < kMaxSlots; ++i) {
    // While a new request for the same source waits for its grant, data of the former one still arrive.
    CellAssembly* assembly = slots_[i].assembly.get();
    if (!assembly || slots_[i].state == Slot::State::empty) continue;
    std::vector<CellEvent> made;
    if (gap) assembly->gap(made);
    const bool had_base = assembly->base_done();
    assembly->take(cells, made);
    append(std::move(made));
    if (assembly->base_done() && !had_base) report_now_ = true;
    if (const auto time = assembly->take_stamp()) {
      delay_.add(*time, static_cast<std::uint32_t>(now.count()));
      stamp(*time, now);
    }
  }
}

/// Passes restored datagrams to the slots like late datagrams. Ignores their times and numbers, because the network
/// lost them.
void CellClient::handle_rebuilt(std::span<const CellRebuilder::Rebuilt> rebuilt) {
  for (const CellRebuilder::Rebuilt& datagram : rebuilt) {
    ++statistics_.rebuilt;
    for (Slot& slot : slots_) {
      if (!slot.assembly || slot.state == Slot::State::empty) continue;
      std::vector<CellEvent> made;
      slot.assembly->take(datagram.cells, made);
      append(std::move(made));
      (void)slot.assembly->take_stamp();
    }
  }
}

std::optional<std::vector<std::byte>> CellClient::next_hello(Instant now) {
  if (now < hello_at_) return std::nullopt;
  if (tries_ >= most_tries()) {
    fail("no cell server answers; expected a GhostSpace server on this UDP port");
    return std::nullopt;
  }
  hello_at_ = now + backed_off(options_.hello_again, tries_++);
  return encode_contract(HelloMessage{nonce_});
}

std::optional<std::vector<std::byte>> CellClient::next_request(Instant now) {
  for (std::size_t i = 0; i < kMaxSlots; ++i) {
    Slot& slot = slots_[i];
    if (slot.state != Slot::State::asking || now < slot.ask) continue;
    if (slot.tries >= most_tries()) {
      fail("the server does not answer a request for " + slot.wish.path);
      return std::nullopt;
    }
    slot.ask = now + backed_off(options_.hello_again, slot.tries++);
    RequestMessage request;
    request.cookie = *cookie_;
    request.number = slot.number;
    request.slot = static_cast<std::uint8_t>(i);
    request.weight = slot.wish.weight;
    request.cells = slot.wish.cells;
    request.streams = slot.wish.streams;
    request.rate = options_.rate;
    request.budget = slot.wish.budget;
    request.path = slot.wish.path;
    return encode_contract(request);
  }
  return std::nullopt;
}

Instant CellClient::report_every() const { return std::clamp(round_trip_, kReportAtMostEvery, kReportAtLeastEvery); }

std::vector<std::byte> CellClient::report(Instant now) {
  report_at_ = now + report_every();
  report_now_ = false;
  ReportMessage message;
  message.session = session_;
  message.number = ++report_number_;
  message.next = history_.next();
  message.received = history_.received();
  message.lost = history_.lost();
  message.loss_rate = static_cast<std::uint32_t>(history_.event_rate() * 4294967295.0);
  message.receive_rate = static_cast<std::uint64_t>(history_.measure_receive_rate(now));
  message.echo = echo_;
  message.held = static_cast<std::uint32_t>((now - echo_at_).count());
  message.rate = options_.rate;
  std::size_t named = 0;
  for (std::size_t i = 0; i < kMaxSlots; ++i) {
    Slot& slot = slots_[i];
    if (slot.state != Slot::State::granted) continue;
    // During a pause, hand out the received cells of incomplete PDUs.
    if (now >= cells_at_ + round_trip_) {
      std::vector<CellEvent> made;
      slot.assembly->gap(made);
      append(std::move(made));
    }
    SlotReport report;
    report.slot = static_cast<std::uint8_t>(i);
    report.number = slot.number;
    report.base_done = slot.assembly->base_done();
    report.regions = slot.regions;
    report.wishes = wishes_of(slot, kMaxNamed - named);
    named += report.wishes.size();
    message.slots.push_back(std::move(report));
  }
  return encode_contract(message);
}

std::optional<std::vector<std::byte>> CellClient::next(Instant now) {
  if (!outbox_.empty()) {
    auto bytes = std::move(outbox_.front());
    outbox_.pop_front();
    return bytes;
  }
  if (phase_ == Phase::active && now >= heard_ + options_.contact_lost && anything_wanted()) {
    CellEvent event;
    event.kind = CellEvent::Kind::lost_contact;
    events_.push_back(std::move(event));
    ++nonce_;
    begin(now);
  }
  if (phase_ == Phase::hello) return next_hello(now);
  if (phase_ != Phase::active) return std::nullopt;
  if (auto request = next_request(now)) return request;
  if (phase_ != Phase::active || session_ == 0 || !anything_wanted()) return std::nullopt;
  if (now < report_at_ && !report_now_) return std::nullopt;
  return report(now);
}

Instant CellClient::deadline(Instant now) const {
  if (!outbox_.empty()) return now;
  if (phase_ == Phase::hello) return std::max(now, hello_at_);
  if (phase_ != Phase::active || !anything_wanted()) return Instant::max();
  Instant first = heard_ + options_.contact_lost;
  for (const Slot& slot : slots_)
    if (slot.state == Slot::State::asking) first = std::min(first, slot.ask);
  if (session_ != 0) first = std::min(first, report_now_ ? now : report_at_);
  return std::max(now, first);
}

std::vector<CellEvent> CellClient::take_events() {
  waiting_ = 0;
  return std::exchange(events_, {});
}

CellClientStatistics CellClient::statistics() const {
  CellClientStatistics result = statistics_;
  result.lost = history_.lost();
  result.loss_event_rate = history_.event_rate();
  result.round_trip = round_trip_;
  for (const Slot& slot : slots_)
    if (slot.assembly) result.damaged_pdus += slot.assembly->damaged();
  return result;
}

}  // namespace gs::net
