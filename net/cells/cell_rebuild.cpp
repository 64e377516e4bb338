#include "net/cells/cell_rebuild.h"

#include <variant>

namespace gs::net {
namespace {

/// Returns the PDU of a parity datagram. Returns nullopt if the cells are not exactly one PDU.
std::optional<Pdu> pdu_of(std::span<const Cell> cells) {
  Reassembler reassembler(1, kMaxCells * kCellPayload);
  std::vector<Pdu> pdus;
  for (const Cell& cell : cells) {
    if (cell.vc != kParityVc || !pdus.empty()) return std::nullopt;
    reassembler.push(cell, pdus);
  }
  if (pdus.size() != 1 || !pdus[0].whole) return std::nullopt;
  return std::move(pdus[0]);
}

}  // namespace

bool CellRebuilder::is_parity(std::span<const Cell> cells) { return !cells.empty() && cells[0].vc == kParityVc; }

void CellRebuilder::keep(std::uint64_t number, std::span<const std::byte> cells) {
  if (!kept_.try_emplace(number, cells.begin(), cells.end()).second) return;
  kept_bytes_ += cells.size();
  for (; kept_bytes_ > kMaxKept; kept_.erase(kept_.begin())) kept_bytes_ -= kept_.begin()->second.size();
}

/// Drops the parity symbols of a group, but remembers the group.
void CellRebuilder::forget(Groups::iterator at) {
  parity_bytes_ -= at->second.symbols.size() * at->second.size;
  at->second.symbols.clear();
}

void CellRebuilder::add(std::uint64_t number, std::span<const std::byte> cells, std::vector<Rebuilt>& out) {
  if (cells.size() > kMaxCells * kPackedCell) return;
  keep(number, cells);
  // A late data datagram may complete the symbols of a group.
  for (auto at = groups_.begin(); at != groups_.end() && at->first <= number; ++at)
    if (!at->second.done && number - at->first < kParitySpan && at->second.members[number - at->first]) look(at, out);
}

std::optional<Parity> CellRebuilder::add_parity(std::uint64_t number, std::span<const Cell> cells,
                                                std::vector<Rebuilt>& out) {
  const auto pdu = pdu_of(cells);
  if (!pdu) return std::nullopt;
  std::span<const std::byte> symbol;
  const auto parity = decode_parity(pdu->bytes, symbol);
  if (!parity || parity->back > number) return std::nullopt;
  const auto [at, made] = groups_.try_emplace(number - parity->back);
  Group& group = at->second;
  if (made) {
    group.members = parity->members;
    group.size = symbol.size();
  } else if (group.done || group.members != parity->members || group.size != symbol.size()) {
    return parity;
  }
  if (group.symbols.try_emplace(parity->symbol, symbol.begin(), symbol.end()).second) parity_bytes_ += group.size;
  look(at, out);
  while (groups_.size() > kMaxGroups || parity_bytes_ > kMaxParity) {
    forget(groups_.begin());
    groups_.erase(groups_.begin());
  }
  return parity;
}

void CellRebuilder::look(Groups::iterator at, std::vector<Rebuilt>& out) {
  Group& group = at->second;
  std::size_t there = 0;
  for (std::size_t i = 0; i < kParitySpan; ++i)
    if (group.members[i] && kept_.contains(at->first + i)) ++there;
  if (there + group.symbols.size() < group.members.count()) return;
  if (there < group.members.count()) rebuild(at->first, group, out);
  group.done = true;
  forget(at);
}

void CellRebuilder::rebuild(std::uint64_t first, const Group& group, std::vector<Rebuilt>& out) {
  const std::size_t count = group.members.count();
  ErasureDecoder decoder({static_cast<std::uint32_t>(count * group.size), static_cast<std::uint16_t>(group.size),
                          static_cast<std::uint8_t>(count)});
  std::vector<std::pair<std::uint64_t, std::size_t>> missing;  // running number, and index among the members
  std::size_t member = 0;
  for (std::size_t i = 0; i < kParitySpan; ++i) {
    if (!group.members[i]) continue;
    if (const auto found = kept_.find(first + i); found != kept_.end()) {
      auto symbol = symbol_of_cells(found->second);
      if (symbol.size() > group.size) return;  // too long for a member of this group
      symbol.resize(group.size);
      (void)decoder.add(0, member, symbol);
    } else {
      missing.emplace_back(first + i, member);
    }
    ++member;
  }
  for (auto parity = group.symbols.begin(); parity != group.symbols.end() && !decoder.done(); ++parity)
    (void)decoder.add(0, parity->first, parity->second);
  if (!decoder.done()) return;
  for (const auto& [number, place] : missing) {
    const auto cells = cells_of_symbol(std::span(decoder.data()).subspan(place * group.size, group.size));
    if (!cells) continue;
    auto bytes = encode_datagram(kCellLabel, narrow_sequence(number), {});
    bytes.insert(bytes.end(), cells->begin(), cells->end());
    auto decoded = decode_datagram(bytes);
    auto* datagram = std::get_if<CellDatagram>(&decoded);
    if (!datagram || is_parity(datagram->cells)) continue;
    keep(number, *cells);
    out.push_back({number, std::move(datagram->cells)});
  }
}

}  // namespace gs::net
