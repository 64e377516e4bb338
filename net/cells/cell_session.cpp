#include "net/cells/cell_session.h"

#include <algorithm>
#include <utility>

namespace gs::net {
namespace {

constexpr Instant kSyncEvery{100'000}, kRegionsAtMostEvery{100'000};
constexpr std::uint64_t kFirstDatagrams = 10;
constexpr std::size_t kMaxWished = 8192, kMaxTried = 16384;
// Minimum free cells to begin another chunk in a datagram with parity. The place PDU of the chunk takes one or two.
constexpr std::size_t kBegin = 6;

std::uint32_t stamp(Instant now) { return static_cast<std::uint32_t>(now.count()); }

std::uint64_t session_burst_of(std::uint64_t rate) { return std::max<std::uint64_t>(2 * kMaxDatagram, rate / 500); }

bool meet(const CellBox& left, const CellBox& right) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (left[axis] > right[axis + 3] || right[axis] > left[axis + 3]) return false;
  return true;
}

}  // namespace

CellSession::CellSession(const Options& options, std::uint64_t id, std::uint64_t nonce, Instant round_trip, Instant now)
    : options_(options),
      id_(id),
      nonce_(nonce),
      controller_(options.response, 0, round_trip, now),
      bucket_(0, session_burst_of(0), now),
      parity_(options.parity),
      last_heard_(now) {}

void CellSession::grant(std::uint64_t bytes_per_second, Instant now) {
  if (granted_ == 0 && bytes_per_second > 0)
    controller_ =
        RateController(options_.response, static_cast<double>(bytes_per_second), controller_.round_trip(), now);
  // As in TCP (RFC 6928), send the first ten datagrams at once, then nothing more in the first round trip.
  if (granted_ == 0) bucket_.allow_debt(std::min<std::uint64_t>(kFirstDatagrams * kMaxDatagram, bytes_per_second / 4));
  granted_ = bytes_per_second;
  controller_.set_grant(static_cast<double>(bytes_per_second));
  update_rate(now);
}

void CellSession::update_rate(Instant now) {
  const auto rate = static_cast<std::uint64_t>(controller_.rate());
  if (rate != bucket_.rate()) bucket_.set_rate(rate, session_burst_of(rate), now);
}

void CellSession::set(const RequestMessage& request, std::shared_ptr<CellSource> source,
                      std::shared_ptr<const ErasureEncoder> base) {
  Slot slot;
  slot.number = request.number;
  slot.weight = std::max<std::uint8_t>(request.weight, 1);
  slot.cells = request.cells;
  slot.streams = request.streams;
  slot.budget = request.budget;
  // If a new request changes only streams or budget, keep the record of sent data.
  Slot& old = slots_[request.slot];
  if (source && old.source == source && old.base == base) {
    slot.states = std::move(old.states);
    slot.base_done = old.base_done;
    slot.base_sent = old.base_sent;
    slot.bytes = old.bytes;
    slot.cutter = std::move(old.cutter);
    slot.wished = std::move(old.wished);
  }
  slot.source = std::move(source);
  slot.base = std::move(base);
  if (slot.source) {
    slot.states.resize(std::min(slot.source->streams(), kMaxStreams));
    for (std::size_t i = 0; i < slot.states.size(); ++i)
      slot.states[i].sent.resize(std::min<std::size_t>(slot.source->chunks(i), kMaxChunks));
    const ErasureLayout& layout = slot.base->layout();
    slot.base_first = layout.blocks() * symbols_for(layout.source, options_.base_loss, options_.base_failure);
  }
  // Start a new slot at the highest turn of all slots. From 0, the slot would get the whole rate until it has caught
  // up.
  for (const Slot& other : slots_)
    if (other.source) slot.turn = std::max(slot.turn, other.turn);
  old = std::move(slot);
  sync_now_ = true;
}

GrantMessage CellSession::answer(std::size_t number) const {
  const Slot& slot = slots_[number];
  GrantMessage message;
  message.session = id_;
  message.number = slot.number;
  message.slot = static_cast<std::uint8_t>(number);
  message.rate = granted_ * 8;
  if (!slot.source) return message;
  message.version = slot.source->version();
  message.delay_aware = options_.response == CongestionResponse::delay_aware;
  message.base = slot.base->layout();
  message.base_crc = aal5_crc(slot.source->base());
  for (std::size_t i = 0; i < slot.states.size(); ++i)
    message.streams.push_back({slot.source->records(i), static_cast<std::uint32_t>(slot.states[i].sent.size())});
  return message;
}

void CellSession::report(const ReportMessage& report, Instant now) {
  if (report.number <= last_report_) return;
  last_report_ = report.number;
  bucket_.allow_debt(0);
  // After silence, the network path may have changed, so start slowly again.
  if (silent(now))
    controller_ = RateController(options_.response, static_cast<double>(granted_), controller_.round_trip(), now);
  last_heard_ = now;
  wanted_ = report.rate / 8;
  const std::uint32_t trip = stamp(now) - report.echo - report.held;
  constexpr std::uint32_t kLongest = 10'000'000;
  if (report.echo != 0 && trip < kLongest) {
    RateController::Feedback feedback;
    feedback.round_trip = Instant(trip);
    feedback.loss_rate = static_cast<double>(report.loss_rate) / 4294967296.0;
    feedback.receive_rate = static_cast<double>(std::min<std::uint64_t>(report.receive_rate, std::uint64_t{1} << 40));
    feedback.limited = std::exchange(idle_, false);
    controller_.feedback(feedback, now);
    update_rate(now);
  }
  report_loss(report, now);
  for (const SlotReport& slot : report.slots)
    if (slots_[slot.slot].source && slots_[slot.slot].number == slot.number)
      handle_report(slots_[slot.slot], slot, now);
}

void CellSession::report_loss(const ReportMessage& report, Instant now) {
  // If nothing is in flight, all datagrams that are not reported as received are lost. Otherwise only datagrams that
  // are received later can prove a loss.
  const bool idle = std::all_of(slots_.begin(), slots_.end(),
                                [](const Slot& slot) { return !slot.source || (slot.ended && slot.base_done); });
  const bool quiet = idle && next_ > 0 && !parity_.pending() && now >= last_cells_ + 2 * controller_.round_trip();
  const std::uint64_t lost = quiet ? std::max(report.lost, next_ - std::min(next_, report.received)) : report.lost;
  const bool settled = parity_.settled(~std::uint64_t{0});
  parity_.report(report.received, lost, quiet, now);
  if (!settled && parity_.settled(~std::uint64_t{0})) sync_now_ = true;  // the end of slots can be reported now
}

void CellSession::handle_report(Slot& slot, const SlotReport& report, Instant now) {
  slot.known = true;
  slot.base_done = report.base_done;
  if (report.regions != slot.regions && now >= slot.regions_changed + kRegionsAtMostEvery) {
    slot.regions = report.regions;
    std::stable_sort(slot.regions.begin(), slot.regions.end(),
                     [](const Region& left, const Region& right) { return left.weight > right.weight; });
    slot.regions_changed = now;
    for (StreamState& state : slot.states) std::fill_n(state.cursors.begin(), kMaxRegions, 0U);
  }
  slot.wishes.clear();
  if (slot.wished.size() >= kMaxWished / 2)
    std::erase_if(slot.wished, [&](const auto& entry) { return now >= entry.second + wish_again(); });
  for (const ChunkRun& run : report.wishes) {
    if (run.first.stream >= slot.states.size()) continue;
    const std::size_t all = slot.states[run.first.stream].sent.size();
    for (std::uint32_t i = 0; i < run.count && run.first.chunk < all && i < all - run.first.chunk; ++i)
      slot.wishes.push_back({run.first.stream, run.first.chunk + i});
  }
  // If all wishes are in flight, the slot has nothing more to send.
  if (std::any_of(slot.wishes.begin(), slot.wishes.end(), [&](const ChunkName& wish) {
        const auto last = slot.wished.find(wish);
        return last == slot.wished.end() || now >= last->second + wish_again();
      }))
    slot.ended = false;
}

/// Returns the time after which the server sends the same wish again.
Instant CellSession::wish_again() const { return controller_.round_trip() * 3 / 2 + Instant(250'000); }

/// Returns the next wish of the client. Skips chunks in flight, because the client repeats a wish until it has the
/// chunk.
std::optional<ChunkName> CellSession::next_wish(Slot& slot, Instant now) {
  while (!slot.wishes.empty()) {
    const ChunkName wish = slot.wishes.front();
    slot.wishes.pop_front();
    const auto last = slot.wished.find(wish);
    if (last != slot.wished.end() && now < last->second + wish_again()) continue;
    if (last == slot.wished.end() && slot.wished.size() >= kMaxWished) continue;
    slot.wished[wish] = now;
    return wish;
  }
  return std::nullopt;
}

/// Returns the next unsent chunk that intersects a region. If `region` is past the last region, returns any unsent
/// chunk.
std::optional<ChunkName> CellSession::next_in(Slot& slot, std::size_t region) {
  for (std::size_t stream = 0; stream < slot.states.size(); ++stream) {
    if ((slot.streams >> stream & 1) == 0) continue;
    StreamState& state = slot.states[stream];
    const bool anywhere = region >= slot.regions.size();
    std::uint32_t& cursor = state.cursors[anywhere ? kMaxRegions : region];
    for (std::size_t tried = 0; cursor < state.sent.size(); ++cursor) {
      if (state.sent[cursor]) continue;
      // Limit the search: a large source with few chunks in the region must not delay other clients. The next call
      // continues the search.
      if (!anywhere && ++tried > kMaxTried) return std::nullopt;
      const auto box = anywhere ? std::nullopt : slot.source->box(stream, cursor);
      if (!box || meet(*box, slot.regions[region].box)) return ChunkName{static_cast<std::uint8_t>(stream), cursor};
    }
  }
  return std::nullopt;
}

std::optional<ChunkName> CellSession::next_chunk(Slot& slot, Instant now) {
  if (const auto wish = next_wish(slot, now)) return wish;
  for (std::size_t region = 0; region <= slot.regions.size(); ++region)
    if (const auto name = next_in(slot, region)) return name;
  return std::nullopt;
}

/// Starts the next chunk unless a chunk is in progress. Returns false if no chunk is left.
bool CellSession::start_chunk(Slot& slot, std::size_t number, Instant now) {
  if (slot.cutter && !slot.cutter->done()) return true;
  slot.cutter.reset();
  if (slot.ended) return false;
  while (slot.budget == 0 || slot.bytes < slot.budget) {
    const auto name = next_chunk(slot, now);
    if (!name) break;
    slot.states[name->stream].sent[name->chunk] = true;
    auto chunk = slot.source->chunk(name->stream, name->chunk);
    const bool records = slot.source->records(name->stream);
    if (!chunk || !ChunkCutter::sound(*chunk, records)) continue;
    Place place;
    place.stream = name->stream;
    place.chunk = name->chunk;
    place.version = slot.source->version();
    slot.cutter.emplace(std::move(*chunk), records, number, place);
    return true;
  }
  slot.ended = sync_now_ = true;
  slot.last_group = parity_.flush(now);
  return false;
}

Instant CellSession::slot_ready(const Slot& slot, Instant now) const {
  if (!slot.source) return Instant::max();
  if (!slot.ended || (slot.cutter && !slot.cutter->done())) return now;
  if (!base_waits(slot)) return Instant::max();
  return slot.base_sent < slot.base_first ? now : std::max(now, slot.base_next);
}

Instant CellSession::ready(Instant now) {
  if (silent(now)) return Instant::max();
  if (now >= controller_.deadline()) {
    controller_.tick(now);
    update_rate(now);
  }
  Instant first = Instant::max();
  for (const Slot& slot : slots_) first = std::min(first, slot_ready(slot, now));
  if (parity_.pending()) first = now;
  if (first == Instant::max()) {
    idle_ = true;
    return first;
  }
  return std::max(first, bucket_.when(kMaxDatagram + kPacketHeaders, now));
}

CellSession::Datagram CellSession::encode(const std::vector<Cell>& cells, bool parity, Instant now) {
  if (cells.empty()) return {};
  Datagram datagram{encode_datagram(kCellLabel, narrow_sequence(next_++), cells), parity};
  bucket_.take(datagram.bytes.size() + kPacketHeaders, now);
  last_cells_ = now;
  return datagram;
}

CellSession::Datagram CellSession::datagram(Instant now) {
  Slot* best = nullptr;
  for (Slot& slot : slots_)
    if (slot_ready(slot, now) <= now && (!best || slot.turn < best->turn)) best = &slot;
  if (parity_.pending() && (!best || parity_.due())) {
    auto made = encode(parity_.next(next_, stamp(now)), true, now);
    if (!parity_.pending()) sync_now_ = sync_now_ || !best;  // the end of slots can be reported now
    return made;
  }
  if (!best) return {};
  const auto number = static_cast<std::size_t>(best - slots_.data());
  std::vector<Cell> cells;
  const ErasureLayout& layout = best->base->layout();
  const bool base_due = base_waits(*best) && (best->base_sent < best->base_first || now >= best->base_next);
  // Send the data symbols of the base first. Then send its parity symbols in three of four datagrams, and chunks in the
  // fourth. Nothing is visible without the base.
  const bool base_first = base_due && (best->base_sent < layout.blocks() * layout.source || ++best->base_turn % 4 != 0);
  if (!base_first) put_data(*best, number, now, cells);
  const bool data = !cells.empty();
  if (cells.empty() && base_due) put_base(*best, number, now, cells);
  auto made = encode(cells, false, now);
  if (data) parity_.add(next_ - 1, std::span(made.bytes).subspan(kDatagramHeader), now);
  best->turn += static_cast<double>(made.bytes.size()) / best->weight;
  return made;
}

void CellSession::put_base(Slot& slot, std::size_t number, Instant now, std::vector<Cell>& cells) {
  const ErasureLayout& layout = slot.base->layout();
  Place place;
  place.kind = PlaceKind::base;
  place.version = slot.source->version();
  place.time = stamp(now);
  place.chunk = static_cast<std::uint32_t>(slot.base_sent % layout.blocks());
  place.at = static_cast<std::uint32_t>(slot.base_sent / layout.blocks() % ErasureLayout::kMaxSymbols);
  place.total = layout.bytes;
  (void)segment(encode_place(place, slot.base->symbol(place.chunk, place.at)), {path_of_slot(number), kBaseVci}, 0,
                false, cells);
  // After the first pass, send further symbols at intervals until the client reports that the base is complete.
  if (++slot.base_sent >= slot.base_first) slot.base_next = now + std::max(controller_.round_trip() / 8, Instant(2000));
}

void CellSession::put_data(Slot& slot, std::size_t number, Instant now, std::vector<Cell>& cells) {
  const bool guarded = parity_.on();
  const std::size_t most = guarded ? protected_cells(slot.cells) : slot.cells;
  while (start_chunk(slot, number, now)) {
    const std::size_t left = most - cells.size();
    // Without parity, add another chunk only if all of it fits, so that a lost datagram damages one chunk. With parity,
    // fill each datagram, because all symbols are as long as the longest datagram.
    if (!cells.empty() && !slot.cutter->fits(left) && (!guarded || left < kBegin)) return;
    slot.bytes += slot.cutter->cut(left, guarded, stamp(now), cells);
    if (cells.size() >= most) return;
  }
}

Instant CellSession::sync_due(Instant now) const {
  if (silent(now)) return Instant::max();
  return sync_now_ ? now : last_sync_ + kSyncEvery;
}

SyncMessage CellSession::sync(Instant now) {
  last_sync_ = now;
  sync_now_ = false;
  SyncMessage message;
  message.session = id_;
  message.time = stamp(now);
  message.next = next_;
  message.granted = granted_ * 8;
  message.rate = static_cast<std::uint64_t>(controller_.rate()) * 8;
  message.round_trip = static_cast<std::uint32_t>(controller_.round_trip().count());
  for (std::size_t i = 0; i < slots_.size(); ++i)
    if (slots_[i].source)
      message.slots.push_back({static_cast<std::uint8_t>(i), slots_[i].number,
                               slots_[i].ended && parity_.settled(slots_[i].last_group), slots_[i].bytes});
  return message;
}

}  // namespace gs::net
