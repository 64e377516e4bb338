#include "qnv/codecs/lossless/tail_pieces.h"

#include "base/bytes.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace gs::qnv::exact {
namespace {

constexpr std::size_t kPieceHeaderBytes = 8;

}  // namespace

std::vector<std::vector<std::byte>> pieces_of(std::span<const std::byte> tail, std::size_t bytes) {
  std::vector<std::vector<std::byte>> pieces;
  for (std::size_t at = 0; at < tail.size(); at += bytes) {
    const auto part = tail.subspan(at, std::min(bytes, tail.size() - at));
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
  if (length > kMaxTailBytes || bytes.size() > length || at > length - bytes.size()) return false;
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

std::vector<std::byte> TailPieces::next() {
  std::vector<std::byte> front;
  for (auto piece = pieces_.find(given_); piece != pieces_.end() && piece->first == given_; ++piece) {
    front.insert(front.end(), piece->second.begin(), piece->second.end());
    given_ += piece->second.size();
  }
  return front;
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
