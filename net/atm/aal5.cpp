#include "net/atm/aal5.h"

#include "net/base/network_bytes.h"

#include <isa-l/crc.h>

#include <algorithm>
#include <utility>

namespace gs::net {
namespace {

constexpr std::uint8_t kLastCell = 1, kNoUserData = 4;  // bits of the payload type (Cell::type)

struct Trailer {
  std::uint8_t user_to_user = 0;
  std::size_t length = 0;
  std::uint32_t crc = 0;
};

Trailer trailer_of(const std::array<std::byte, kCellPayload>& payload) {
  NetworkReader reader{std::span(payload).last<kAal5Trailer>()};
  Trailer trailer;
  trailer.user_to_user = reader.integer<std::uint8_t>();
  (void)reader.integer<std::uint8_t>();  // common part indicator
  trailer.length = reader.integer<std::uint16_t>();
  trailer.crc = reader.integer<std::uint32_t>();
  return trailer;
}

/// Joins consecutive cells to a complete PDU. The last cell must hold the trailer. Returns nullopt if the length or the
/// CRC is wrong.
std::optional<Pdu> whole_pdu(Vc vc, std::span<const Pdu::Part> parts) {
  const Trailer trailer = trailer_of(parts.back().payload);
  if (trailer.length == 0 || cells_of_pdu(trailer.length) != parts.size()) return std::nullopt;
  Pdu pdu;
  pdu.vc = vc;
  pdu.whole = true;
  pdu.user_to_user = trailer.user_to_user;
  pdu.bytes.reserve(parts.size() * kCellPayload);
  for (const Pdu::Part& part : parts) pdu.bytes.insert(pdu.bytes.end(), part.payload.begin(), part.payload.end());
  if (aal5_crc(std::span(pdu.bytes).first(pdu.bytes.size() - 4)) != trailer.crc) return std::nullopt;
  pdu.bytes.resize(trailer.length);
  return pdu;
}

void hand_out_parts(Vc vc, std::uint64_t key, std::span<const Pdu::Part> parts, std::vector<Pdu>& out) {
  if (parts.empty()) return;
  Pdu pdu;
  pdu.vc = vc;
  pdu.key = key;
  pdu.parts.assign(parts.begin(), parts.end());
  out.push_back(std::move(pdu));
}

}  // namespace

std::uint32_t aal5_crc(std::span<const std::byte> bytes) {
  // ISA-L expects a pointer to non-const bytes. It inverts the start value and the result.
  return crc32_ieee(0, reinterpret_cast<unsigned char*>(const_cast<std::byte*>(bytes.data())), bytes.size());
}

bool segment(std::span<const std::byte> user, Vc vc, std::uint8_t user_to_user, bool low_priority,
             std::vector<Cell>& cells) {
  if (user.empty() || user.size() > kMaxPdu) return false;
  const std::size_t count = cells_of_pdu(user.size());
  std::vector<std::byte> pdu(user.begin(), user.end());
  pdu.reserve(count * kCellPayload);
  pdu.resize(count * kCellPayload - kAal5Trailer);
  NetworkWriter writer(pdu);
  writer.integer(user_to_user);
  writer.integer(std::uint8_t{0});
  writer.integer(static_cast<std::uint16_t>(user.size()));
  writer.integer(aal5_crc(pdu));
  for (std::size_t i = 0; i < count; ++i) {
    Cell& cell = cells.emplace_back();
    cell.vc = vc;
    cell.type = i + 1 == count ? kLastCell : 0;
    cell.low_priority = low_priority;
    std::copy_n(pdu.begin() + static_cast<std::ptrdiff_t>(i * kCellPayload), kCellPayload, cell.payload.begin());
  }
  return true;
}

Reassembler::Reassembler(std::size_t most_vcs, std::size_t most_pdu)
    : most_vcs_(std::max<std::size_t>(most_vcs, 1)), most_cells_(cells_of_pdu(std::min(most_pdu, kMaxPdu))) {}

Reassembler::State& Reassembler::state(Vc vc, std::vector<Pdu>& out) {
  auto found = states_.find(vc);
  if (found == states_.end()) {
    if (states_.size() >= most_vcs_) {
      const auto oldest = std::min_element(states_.begin(), states_.end(), [](const auto& left, const auto& right) {
        return left.second.used < right.second.used;
      });
      lost(oldest->first, oldest->second, out);
      states_.erase(oldest);
    }
    found = states_.emplace(vc, State{}).first;
  }
  found->second.used = ++clock_;
  return found->second;
}

void Reassembler::push(const Cell& cell, std::vector<Pdu>& out) {
  if ((cell.type & kNoUserData) != 0) return;
  State& state = this->state(cell.vc, out);
  const bool last = (cell.type & kLastCell) != 0;
  if (state.next >= most_cells_ || state.parts.size() >= most_cells_) {
    state.overflow = true;
    state.parts.clear();
  }
  if (!state.overflow) state.parts.push_back({state.next++, last, cell.payload});
  if (!last) return;
  if (!state.overflow) end(cell.vc, state, out);
  const std::uint64_t used = state.used;
  state = State{};
  state.used = used;
}

/// Ends the current PDU after its last cell. Appends the PDU to `out`.
void Reassembler::end(Vc vc, State& state, std::vector<Pdu>& out) {
  if (!state.placed) return end_after_gap(vc, state, out);
  if (state.gap) return hand_out_parts(vc, state.key, state.parts, out);
  if (auto pdu = whole_pdu(vc, state.parts)) {
    pdu->key = state.key;
    out.push_back(std::move(*pdu));
  } else {
    ++damaged_;
  }
}

/// Ends a PDU of which leading cells may be missing. Derives the indexes of its cells from the length in the trailer.
void Reassembler::end_after_gap(Vc vc, State& state, std::vector<Pdu>& out) {
  const std::size_t total = cells_of_pdu(trailer_of(state.parts.back().payload).length);
  const auto first = static_cast<std::uint32_t>(total - state.parts.size());
  if (state.parts.size() < total) {
    for (Pdu::Part& part : state.parts) part.place += first;
    return hand_out_parts(vc, 0, state.parts, out);
  }
  auto pdu = state.parts.size() == total ? whole_pdu(vc, state.parts) : std::nullopt;
  if (pdu)
    out.push_back(std::move(*pdu));
  else
    ++damaged_;
}

void Reassembler::lost(Vc vc, State& state, std::vector<Pdu>& out) {
  if (state.overflow) return;
  // If the first cell is unknown, no cell has a known index, so all are dropped.
  if (state.placed) hand_out_parts(vc, state.key, state.parts, out);
  const std::uint64_t used = state.used;
  state = State{};
  state.used = used;
  state.placed = false;
}

void Reassembler::lost_anywhere(std::vector<Pdu>& out) {
  for (auto& [vc, state] : states_) lost(vc, state, out);
}

void Reassembler::seek(Vc vc, std::uint64_t key, std::uint32_t place, std::vector<Pdu>& out) {
  State& state = this->state(vc, out);
  if (!state.placed || state.overflow || state.key != key || place < state.next) {
    lost(vc, state, out);
    const std::uint64_t used = state.used;
    state = State{};
    state.used = used;
    state.key = key;
    state.gap = place > 0;
  } else if (place > state.next) {
    state.gap = true;
  }
  state.next = place;
  state.overflow = place >= most_cells_;
}

}  // namespace gs::net
