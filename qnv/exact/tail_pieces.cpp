#include "qnv/exact/tail_pieces.h"

#include "qnv/base/bytes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::qnv::exact {
namespace {

constexpr std::size_t kPieceBytes = 16384, kPieceHeaderBytes = 8;

}  // namespace

std::vector<std::vector<std::byte>> pieces_of(std::span<const std::byte> tail) {
  std::vector<std::vector<std::byte>> pieces;
  for (std::size_t at = 0; at < tail.size(); at += kPieceBytes) {
    const auto part = tail.subspan(at, std::min(kPieceBytes, tail.size() - at));
    std::vector<std::byte>& piece = pieces.emplace_back();
    ByteWriter out(piece);
    out.integer(static_cast<std::uint32_t>(at));
    out.integer(static_cast<std::uint32_t>(tail.size()));
    piece.insert(piece.end(), part.begin(), part.end());
  }
  return pieces;
}

bool TailPieces::add(std::span<const std::byte> payload) {
  ByteReader in(payload);
  const std::size_t at = in.integer<std::uint32_t>(), length = in.integer<std::uint32_t>();
  if (!in.good() || payload.size() == kPieceHeaderBytes) return false;
  const auto bytes = payload.subspan(kPieceHeaderBytes);
  if (length > kMostTailBytes || bytes.size() > length || at > length - bytes.size()) return false;
  if (length_ != 0 && length != length_) return false;
  const auto behind = pieces_.lower_bound(at);
  if (behind != pieces_.end() && behind->first == at && std::ranges::equal(behind->second, bytes)) return true;
  if (behind != pieces_.end() && behind->first < at + bytes.size()) return false;
  if (behind != pieces_.begin() && std::prev(behind)->first + std::prev(behind)->second.size() > at) return false;
  length_ = length;
  come_ += bytes.size();
  pieces_.emplace_hint(behind, at, std::vector<std::byte>(bytes.begin(), bytes.end()));
  return true;
}

std::optional<std::vector<std::byte>> TailPieces::take() {
  if (length_ == 0 || come_ < length_) return {};
  std::vector<std::byte> tail;
  tail.reserve(length_);
  for (const auto& [at, piece] : pieces_) tail.insert(tail.end(), piece.begin(), piece.end());
  pieces_.clear();
  return tail;
}

}  // namespace gs::qnv::exact
