#include "qnv/container/piece_group.h"

#include "base/bytes.h"
#include "qnv/base/short_number.h"
#include "qnv/container/cauchy_code.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::qnv {
namespace {

constexpr std::size_t kPieceHeaderBytes = 7;

}  // namespace

CutGroup cut_group(int number, std::span<const std::vector<std::byte>> payloads, double parity, std::size_t besides,
                   std::size_t aimed) {
  std::vector<std::byte> bytes;
  for (const std::vector<std::byte>& payload : payloads) {
    put_number(bytes, static_cast<std::uint32_t>(payload.size()));
    bytes.insert(bytes.end(), payload.begin(), payload.end());
  }
  PieceHeader header{number, bytes.size(), 1, 0};
  header.needed = std::clamp<std::size_t>((bytes.size() + aimed - 1) / aimed, 1, kMaxPieces);
  const std::size_t size = header.size();
  bytes.resize(header.needed * size);
  CutGroup cut;
  const auto begin = [&](std::vector<std::vector<std::byte>>& pieces) -> std::vector<std::byte>& {
    std::vector<std::byte>& payload = pieces.emplace_back();
    ByteWriter out(payload);
    out.integer(static_cast<std::uint8_t>(number));
    out.integer(static_cast<std::uint8_t>(header.needed));
    out.integer(static_cast<std::uint8_t>(header.number++));
    out.integer(static_cast<std::uint32_t>(header.length));
    return payload;
  };
  const auto data = [&](std::size_t i) { return std::span(bytes).subspan(i * size, size); };
  for (std::size_t i = 0; i < header.needed; ++i) {
    std::vector<std::byte>& payload = begin(cut.data);
    payload.insert(payload.end(), data(i).begin(), data(i).end());
  }
  const auto more = static_cast<std::size_t>(std::ceil(parity * static_cast<double>(header.needed))) + besides;
  while (cut.parity.size() < std::min(more, kMaxCodedPieces - header.needed)) {
    std::vector<std::byte>& payload = begin(cut.parity);
    payload.resize(kPieceHeaderBytes + size);
    for (std::size_t i = 0; i < header.needed; ++i)
      add_weighted(std::span(payload).subspan(kPieceHeaderBytes), cauchy_weight(header.number - 1, i), data(i));
  }
  return cut;
}

std::optional<PieceHeader> read_piece_header(std::span<const std::byte> payload) {
  ByteReader in(payload);
  PieceHeader header;
  header.group = in.integer<std::uint8_t>();
  header.needed = in.integer<std::uint8_t>();
  header.number = in.integer<std::uint8_t>();
  header.length = in.integer<std::uint32_t>();
  if (!in.good() || header.group > kMaxGroup || header.needed < 1 || header.needed > kMaxPieces || header.length < 1 ||
      header.size() > kMaxPieceBytes || payload.size() != kPieceHeaderBytes + header.size())
    return {};
  return header;
}

bool PieceGroup::add(const PieceHeader& header, std::span<const std::byte> payload) {
  if (needed_ != 0 && (header.needed != needed_ || header.length != length_)) return false;
  needed_ = header.needed;
  length_ = header.length;
  if (header.number < joined_ || joined_ == needed_) return true;
  const auto bytes = payload.subspan(kPieceHeaderBytes);
  pieces_.try_emplace(header.number, bytes.begin(), bytes.end());
  if (joined_ + pieces_.size() >= needed_) restore();
  for (auto next = pieces_.begin(); next != pieces_.end() && next->first == joined_ && joined_ < needed_; ++joined_) {
    front_.insert(front_.end(), next->second.begin(), next->second.end());
    next = pieces_.erase(next);
  }
  if (joined_ == needed_) {
    pieces_.clear();
    front_.resize(length_);
  }
  return true;
}

std::vector<std::vector<std::byte>> PieceGroup::take() {
  std::vector<std::vector<std::byte>> payloads;
  while (read_ < front_.size()) {
    const std::span<const std::byte> front(front_);
    ByteReader in(front.subspan(read_));
    const std::size_t bytes = get_number(in);
    const std::size_t at = front_.size() - in.left();
    if (!in.good() || bytes > in.left() || at + bytes > length_) break;
    payloads.emplace_back(front_.begin() + static_cast<std::ptrdiff_t>(at),
                          front_.begin() + static_cast<std::ptrdiff_t>(at + bytes));
    read_ = at + bytes;
  }
  if (joined_ == needed_) {
    front_ = {};
    read_ = 0;
  }
  return payloads;
}

void PieceGroup::restore() {
  const std::size_t size = pieces_.begin()->second.size();
  std::vector<std::size_t> missing;
  for (std::size_t i = joined_; i < needed_; ++i)
    if (!pieces_.contains(i)) missing.push_back(i);
  std::vector<CodeEquation> rows;
  for (auto parity = pieces_.lower_bound(needed_); rows.size() < missing.size(); ++parity) {
    CodeEquation& row = rows.emplace_back();
    for (const std::size_t i : missing) row.weights.push_back(cauchy_weight(parity->first, i));
    row.sum = parity->second;
    for (std::size_t i = 0; i < joined_; ++i)
      add_weighted(row.sum, cauchy_weight(parity->first, i), std::span(front_).subspan(i * size, size));
    for (auto known = pieces_.begin(); known->first < needed_; ++known)
      add_weighted(row.sum, cauchy_weight(parity->first, known->first), known->second);
  }
  solve_pieces(rows);
  for (std::size_t i = 0; i < rows.size(); ++i) pieces_[missing[i]] = std::move(rows[i].sum);
}

bool PieceGroups::add(std::span<const std::byte> payload, const Take& take) {
  const auto piece = read_piece_header(payload);
  if (!piece) return false;
  PieceGroup& group = groups_[piece->group];
  const bool good = group.add(*piece, payload);
  for (const std::vector<std::byte>& each : group.take()) take(type_of_group(piece->group), each);
  return good;
}

}  // namespace gs::qnv
