#include "qnv/codecs/shared/spill_store.h"

#include <algorithm>
#include <cstring>

namespace gs::qnv {

namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 18;

}  // namespace

bool MemoryStore::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    if (pieces_.empty() || pieces_.back().size() == kPieceBytes) pieces_.emplace_back().reserve(kPieceBytes);
    const auto part = bytes.first(std::min(bytes.size(), kPieceBytes - pieces_.back().size()));
    pieces_.back().insert(pieces_.back().end(), part.begin(), part.end());
    size_ += part.size();
    bytes = bytes.subspan(part.size());
  }
  return true;
}

bool MemoryStore::read(std::uint64_t offset, std::span<std::byte> to) const {
  if (offset > size_ || to.size() > size_ - offset) return false;
  while (!to.empty()) {
    const std::vector<std::byte>& piece = pieces_[offset / kPieceBytes];
    const std::size_t at = offset % kPieceBytes, count = std::min(to.size(), piece.size() - at);
    std::memcpy(to.data(), piece.data() + at, count);
    offset += count;
    to = to.subspan(count);
  }
  return true;
}

}  // namespace gs::qnv
