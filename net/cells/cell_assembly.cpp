#include "net/cells/cell_assembly.h"

#include <algorithm>

namespace gs::net {
namespace {

// Maximum bytes of a received PDU: the servers send each PDU in one datagram.
constexpr std::size_t kMaxPduHere = kMaxCells * kCellPayload;

std::uint64_t key_of(std::uint32_t chunk, std::uint32_t pdu) { return (std::uint64_t{chunk} << 32 | pdu) + 1; }

using Ranges = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// Adds a range. Returns false if the ranges already contained all of it.
bool add_range(Ranges& ranges, std::uint32_t begin, std::uint32_t end) {
  const auto first = std::lower_bound(ranges.begin(), ranges.end(), begin,
                                      [](const auto& range, auto at) { return range.second < at; });
  if (first != ranges.end() && first->first <= begin && end <= first->second) return false;
  auto last = first;
  for (; last != ranges.end() && last->first <= end; ++last) {
    begin = std::min(begin, last->first);
    end = std::max(end, last->second);
  }
  ranges.insert(ranges.erase(first, last), {begin, end});
  return true;
}

/// Returns the parts of the range from `begin` to `end` that `ranges` does not contain.
Ranges missing_in(const Ranges& ranges, std::uint32_t begin, std::uint32_t end) {
  Ranges missing;
  for (const auto& [from, to] : ranges) {
    if (to <= begin) continue;
    if (from >= end) break;
    if (from > begin) missing.emplace_back(begin, from);
    begin = std::max(begin, to);
  }
  if (begin < end) missing.emplace_back(begin, end);
  return missing;
}

bool complete(const Ranges& ranges, std::uint32_t total) {
  return ranges.size() == 1 && ranges[0].first == 0 && ranges[0].second >= total;
}

}  // namespace

CellAssembly::CellAssembly(std::size_t slot, const GrantMessage& grant)
    : path_(path_of_slot(slot)),
      slot_(static_cast<std::uint8_t>(slot)),
      version_(grant.version),
      base_crc_(grant.base_crc),
      reassembler_(kMaxStreams + 2, kMaxPduHere),
      streams_(std::min(grant.streams.size(), kMaxStreams)) {
  layout_ = grant.base;
  if (layout_.sound()) base_.emplace(layout_);
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    streams_[i].records = grant.streams[i].records;
    streams_[i].done.resize(std::min<std::size_t>(grant.streams[i].chunks, kMaxChunks));
  }
}

bool CellAssembly::continues(const GrantMessage& grant) const {
  if (grant.version != version_ || grant.base_crc != base_crc_ || grant.streams.size() != streams_.size()) return false;
  // While the base is incomplete, the new grant must keep its layout. The received symbols fit no other layout.
  if (!base_done_ &&
      (grant.base.bytes != layout_.bytes || grant.base.symbol != layout_.symbol || grant.base.source != layout_.source))
    return false;
  for (std::size_t i = 0; i < streams_.size(); ++i)
    if (grant.streams[i].records != streams_[i].records || grant.streams[i].chunks != streams_[i].done.size())
      return false;
  return true;
}

void CellAssembly::take(std::span<const Cell> cells, std::vector<CellEvent>& out) {
  for (Stream& stream : streams_) stream.group.current = false;
  for (const Cell& cell : cells)
    if (cell.vc.vpi == path_) handle_cell(cell, out);
}

void CellAssembly::gap(std::vector<CellEvent>& out) {
  reassembler_.lost_anywhere(pdus_);
  handle_pdus(out);
}

void CellAssembly::handle_cell(const Cell& cell, std::vector<CellEvent>& out) {
  const std::size_t stream = std::size_t{cell.vc.vci} - kFirstDataVci;
  const bool data = cell.vc.vci >= kFirstDataVci && stream < streams_.size();
  if (!data && cell.vc.vci != kBaseVci && cell.vc.vci != kPlaceVci) return;
  if (data && streams_[stream].records) {
    // Cells of records hold no chunk number. Without a preceding place PDU, they are useless.
    Group& group = streams_[stream].group;
    if (!group.current || group.next >= cells_of_records(group.place.total)) return;
    const std::uint32_t number = group.next++;
    constexpr auto kPduCells = static_cast<std::uint32_t>(kRecordPduCells);
    reassembler_.seek(cell.vc, key_of(group.place.chunk, number / kPduCells), number % kPduCells, pdus_);
  }
  reassembler_.push(cell, pdus_);
  handle_pdus(out);
}

void CellAssembly::handle_pdus(std::vector<CellEvent>& out) {
  for (const Pdu& pdu : pdus_) {
    if (pdu.vc.vci == kPlaceVci) {
      handle_place(pdu);
    } else if (pdu.vc.vci == kBaseVci) {
      handle_base(pdu, out);
    } else {
      const std::size_t stream = std::size_t{pdu.vc.vci} - kFirstDataVci;
      if (streams_[stream].records)
        handle_records(stream, pdu, out);
      else
        handle_piece(stream, pdu, out);
    }
  }
  pdus_.clear();
}

void CellAssembly::handle_place(const Pdu& pdu) {
  std::span<const std::byte> head;
  const auto place = pdu.whole ? decode_place(pdu.bytes, head) : std::nullopt;
  if (!place || place->kind != PlaceKind::records || place->version != version_ || place->stream >= streams_.size())
    return;
  Stream& stream = streams_[place->stream];
  if (place->chunk >= stream.done.size()) return;
  stamp_ = place->time;
  // Cells of the previous chunk may still wait in the reassembler, so keep its place.
  if (place->chunk != stream.group.place.chunk) stream.previous = std::move(stream.group);
  stream.group = {true, *place, {head.begin(), head.end()}, place->at};
}

void CellAssembly::handle_base(const Pdu& pdu, std::vector<CellEvent>& out) {
  std::span<const std::byte> symbol;
  const auto place = pdu.whole ? decode_place(pdu.bytes, symbol) : std::nullopt;
  if (!place || place->kind != PlaceKind::base || place->version != version_) return;
  stamp_ = place->time;
  if (!base_ || place->total != base_->layout().bytes) return;
  (void)base_->add(place->chunk, place->at, symbol);
  if (!base_->done()) return;
  if (aal5_crc(base_->data()) != base_crc_) {
    base_.emplace(base_->layout());  // a symbol was wrong: receive the base again
    return;
  }
  CellEvent event;
  event.kind = CellEvent::Kind::base;
  event.slot = slot_;
  event.version = version_;
  event.bytes = base_->data();
  out.push_back(std::move(event));
  base_.reset();
  base_done_ = true;
}

void CellAssembly::handle_piece(std::size_t stream, const Pdu& pdu, std::vector<CellEvent>& out) {
  std::span<const std::byte> bytes;
  const auto place = pdu.whole ? decode_place(pdu.bytes, bytes) : std::nullopt;
  if (!place || place->kind != PlaceKind::piece || place->version != version_ || place->stream != stream) return;
  stamp_ = place->time;
  std::vector<bool>& done = streams_[stream].done;
  if (place->chunk >= done.size() || done[place->chunk]) return;
  const ChunkName name{place->stream, place->chunk};
  CellEvent event;
  event.kind = CellEvent::Kind::piece;
  event.slot = slot_;
  event.version = version_;
  event.name = name;
  event.total = place->total;
  if (bytes.size() == place->total) {
    event.bytes.assign(bytes.begin(), bytes.end());
  } else {
    Progress& progress = this->progress(name, place->total);
    if (!add_range(progress.ranges, place->at, place->at + static_cast<std::uint32_t>(bytes.size()))) return;
    std::copy(bytes.begin(), bytes.end(), progress.bytes.begin() + place->at);
    if (!complete(progress.ranges, place->total)) return;
    waiting_bytes_ -= progress.bytes.size();
    event.bytes = std::move(progress.bytes);
  }
  if (const auto found = progress_.find(name); found != progress_.end()) {
    waiting_bytes_ -= found->second.bytes.size();
    progress_.erase(found);
  }
  done[place->chunk] = true;
  out.push_back(std::move(event));
}

void CellAssembly::handle_records(std::size_t stream, const Pdu& pdu, std::vector<CellEvent>& out) {
  if (pdu.key == 0) return;
  const auto chunk = static_cast<std::uint32_t>((pdu.key - 1) >> 32);
  const std::uint64_t first = ((pdu.key - 1) & 0xffffffff) * kRecordPdu;
  const Stream& at = streams_[stream];
  const Group* group = at.group.place.chunk == chunk      ? &at.group
                       : at.previous.place.chunk == chunk ? &at.previous
                                                          : nullptr;
  if (!group || first >= group->place.total) return;
  const auto offset = static_cast<std::uint32_t>(first);
  const std::size_t size = std::min<std::size_t>(kRecordPdu, group->place.total - offset);
  if (pdu.whole) {
    if (pdu.bytes.size() == size) put_records(stream, *group, offset, pdu.bytes, out);
    return;
  }
  for (const Pdu::Part& part : pdu.parts) {
    const std::size_t from = std::size_t{part.place} * kCellPayload;
    // If the PDU ends at another cell than its place states, its cells belong to another chunk.
    if (part.last != (part.place + 1 == cells_of_pdu(size)) || from >= size) continue;
    put_records(stream, *group, offset + static_cast<std::uint32_t>(from),
                std::span(part.payload).first(std::min(kCellPayload, size - from)), out);
  }
}

void CellAssembly::put_records(std::size_t stream, const Group& group, std::uint32_t offset,
                               std::span<const std::byte> bytes, std::vector<CellEvent>& out) {
  const ChunkName name{static_cast<std::uint8_t>(stream), group.place.chunk};
  std::vector<bool>& done = streams_[stream].done;
  if (done[name.chunk]) return;
  Progress& progress = this->progress(name, group.place.total);
  const std::uint32_t end = offset + static_cast<std::uint32_t>(bytes.size());
  for (const auto& [from, to] : missing_in(progress.ranges, offset, end))
    hand_out_records(name, group, from, bytes.subspan(from - offset, to - from), out);
  (void)add_range(progress.ranges, offset, end);
  if (!complete(progress.ranges, group.place.total)) return;
  done[name.chunk] = true;
  progress_.erase(name);
}

void CellAssembly::hand_out_records(const ChunkName& name, const Group& group, std::uint32_t offset,
                                    std::span<const std::byte> bytes, std::vector<CellEvent>& out) {
  // Append to the previous event if its bytes end where these begin.
  if (!out.empty()) {
    CellEvent& last = out.back();
    if (last.kind == CellEvent::Kind::piece && last.records && last.name == name && last.total == group.place.total &&
        last.head == group.head && last.offset + last.bytes.size() == offset) {
      last.bytes.insert(last.bytes.end(), bytes.begin(), bytes.end());
      return;
    }
  }
  CellEvent event;
  event.kind = CellEvent::Kind::piece;
  event.slot = slot_;
  event.version = version_;
  event.name = name;
  event.records = true;
  event.total = group.place.total;
  event.offset = offset;
  event.head = group.head;
  event.bytes.assign(bytes.begin(), bytes.end());
  out.push_back(std::move(event));
}

void CellAssembly::forget(std::map<ChunkName, Progress>::iterator at) {
  waiting_bytes_ -= at->second.bytes.size();
  progress_.erase(at);
}

void CellAssembly::forget_one() {
  if (progress_.empty()) return;
  forget(std::min_element(progress_.begin(), progress_.end(), [](const auto& left, const auto& right) {
    return left.second.touched < right.second.touched;
  }));
}

CellAssembly::Progress& CellAssembly::progress(const ChunkName& name, std::uint32_t total) {
  const bool records = streams_[name.stream].records;
  if (const auto found = progress_.find(name); found != progress_.end()) {
    found->second.touched = ++clock_;
    if (found->second.total == total) return found->second;
    forget(found);  // another length means that the chunk has changed
  }
  while (progress_.size() >= kMaxProgress || (!records && waiting_bytes_ + total > kMaxWaiting && !progress_.empty()))
    forget_one();
  Progress& made = progress_[name];
  made.total = total;
  made.touched = ++clock_;
  if (!records) made.bytes.resize(total);
  waiting_bytes_ += made.bytes.size();
  return made;
}

bool CellAssembly::has(const ChunkName& name) const {
  return name.stream >= streams_.size() || name.chunk >= streams_[name.stream].done.size() ||
         streams_[name.stream].done[name.chunk];
}

void CellAssembly::forget(const ChunkName& name) {
  if (name.stream < streams_.size() && name.chunk < streams_[name.stream].done.size())
    streams_[name.stream].done[name.chunk] = false;
}

std::vector<ChunkName> CellAssembly::missing(std::uint32_t streams, std::size_t most) const {
  std::vector<ChunkName> names;
  for (std::size_t stream = 0; stream < streams_.size(); ++stream)
    for (std::size_t chunk = 0;
         (streams >> stream & 1) != 0 && chunk < streams_[stream].done.size() && names.size() < most; ++chunk)
      if (!streams_[stream].done[chunk])
        names.push_back({static_cast<std::uint8_t>(stream), static_cast<std::uint32_t>(chunk)});
  return names;
}

}  // namespace gs::net
