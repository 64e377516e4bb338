#include "qnv/codecs/values/labels/encode/stored_labels.h"

#include "qnv/base/short_number.h"

#include <algorithm>

namespace gs::qnv::values {

static_assert(kTileEdge % StoredLabels::kDepth == 0 && kTileEdge % kCubeEdge == 0);

std::optional<std::uint64_t> SharedStore::append(std::span<const std::byte> bytes) {
  const std::lock_guard lock(mutex_);
  const std::uint64_t offset = store_.size();
  if (store_.append(bytes)) return offset;
  failed_ = true;
  return std::nullopt;
}

bool SharedStore::read(std::uint64_t offset, std::span<std::byte> to) const {
  const std::lock_guard lock(mutex_);
  if (store_.read(offset, to)) return true;
  failed_ = true;
  return false;
}

void SharedStore::publish() {
  const std::lock_guard lock(mutex_);
  if (!store_.publish()) failed_ = true;
}

std::string SharedStore::problem() const {
  const std::lock_guard lock(mutex_);
  return store_.problem();
}

StoredLabels::StoredLabels(Extent extent, SharedStore& store) : extent_(extent), store_(&store) {
  pieces_ = {(extent[0] - 1) / kTileEdge + 1, (extent[1] - 1) / kTileEdge + 1, (extent[2] - 1) / kDepth + 1};
  places_.reserve(std::size_t{pieces_[0]} * pieces_[1] * pieces_[2]);
}

Extent StoredLabels::size_of(const Extent& piece) const {
  return {std::min(kTileEdge, extent_[0] - piece[0] * kTileEdge),
          std::min(kTileEdge, extent_[1] - piece[1] * kTileEdge), std::min(kDepth, extent_[2] - piece[2] * kDepth)};
}

StoredLabels::Packed StoredLabels::pack(std::span<const std::uint32_t> labels) {
  Packed piece;
  piece.label = labels.front();
  for (std::size_t at = 0; at < labels.size();) {
    std::size_t end = at + 1;
    while (end < labels.size() && labels[end] == labels[at]) ++end;
    if (end - at == labels.size()) break;
    put_number(piece.bytes, end - at);
    put_number(piece.bytes, labels[at]);
    at = end;
  }
  return piece;
}

bool StoredLabels::append(const Packed& piece) {
  if (piece.bytes.empty()) {
    places_.push_back({piece.label, 0});
    return true;
  }
  const auto offset = store_->append(piece.bytes);
  places_.push_back({offset.value_or(0), static_cast<std::uint32_t>(piece.bytes.size())});
  return offset.has_value();
}

std::optional<std::uint32_t> StoredLabels::uniform(const Extent& piece) const {
  const Place& here = place(piece);
  return here.bytes == 0 ? std::optional(index_of(static_cast<std::uint32_t>(here.offset))) : std::nullopt;
}

bool StoredLabels::each_run(const Extent& piece,
                            const std::function<void(std::uint32_t label, std::size_t count)>& take) const {
  const Place& here = place(piece);
  if (here.bytes == 0) {
    take(index_of(static_cast<std::uint32_t>(here.offset)), sample_count(size_of(piece)));
    return true;
  }
  thread_local std::vector<std::byte> bytes;
  bytes.resize(here.bytes);
  if (!store_->read(here.offset, bytes)) return false;
  std::uint32_t code = 0, label = index_of(0);
  for (std::span<const std::byte> left = bytes; !left.empty();) {
    const auto count = take_wide_number(left), next = take_wide_number(left);
    if (!count || !next) return false;
    if (static_cast<std::uint32_t>(*next) != code) {
      code = static_cast<std::uint32_t>(*next);
      label = index_of(code);
    }
    take(label, static_cast<std::size_t>(*count));
  }
  return true;
}

bool StoredLabels::read(const Extent& piece, std::span<std::uint32_t> to) const {
  return each_run(piece, [&to](std::uint32_t label, std::size_t count) {
    count = std::min(count, to.size());
    std::ranges::fill(to.first(count), label);
    to = to.subspan(count);
  });
}

LabelTiles::LabelTiles(const StoredLabels& level, std::size_t most) : level_(level), most_(most) {
  for (std::size_t a = 0; a < 3; ++a) count_[a] = (level.extent()[a] - 1) / kTileEdge + 1;
}

const LabelTiles::Tile& LabelTiles::tile(const Extent& tile) {
  const std::uint64_t number = (std::uint64_t{tile[2]} * count_[1] + tile[1]) * count_[0] + tile[0];
  if (number == last_number_) return *last_;
  auto found = tiles_.find(number);
  if (found == tiles_.end()) {
    Tile made;
    if (tiles_.size() >= most_) {
      const auto oldest = std::ranges::min_element(tiles_, {}, [](const auto& one) { return one.second.used; });
      made.labels = std::move(oldest->second.labels);
      tiles_.erase(oldest);
    }
    load(tile, made);
    found = tiles_.emplace(number, std::move(made)).first;
  }
  found->second.used = ++time_;
  last_number_ = number;
  last_ = &found->second;
  return *last_;
}

void LabelTiles::load(const Extent& at, Tile& tile) const {
  constexpr std::uint32_t kPieces = kTileEdge / StoredLabels::kDepth;
  const std::uint32_t first = at[2] * kPieces, last = std::min(first + kPieces, level_.pieces()[2]);
  tile.size = level_.size_of({at[0], at[1], first});
  tile.size[2] = std::min(kTileEdge, level_.extent()[2] - at[2] * kTileEdge);
  const auto label = level_.uniform({at[0], at[1], first});
  bool equal = label.has_value();
  for (std::uint32_t z = first + 1; z < last && equal; ++z) equal = level_.uniform({at[0], at[1], z}) == label;
  if (equal) {
    tile.label = *label;
    tile.labels = {};
    return;
  }
  tile.labels.resize(sample_count(tile.size));
  std::span<std::uint32_t> to = tile.labels;
  for (std::uint32_t z = first; z < last; ++z) {
    const std::size_t count = sample_count(level_.size_of({at[0], at[1], z}));
    (void)level_.read({at[0], at[1], z}, to.first(count));
    to = to.subspan(count);
  }
}

CubeLabels LabelTiles::cube(const Extent& cube) {
  constexpr std::uint32_t kCubes = kTileEdge / kCubeEdge;
  const Tile& tile = this->tile({cube[0] / kCubes, cube[1] / kCubes, cube[2] / kCubes});
  if (tile.labels.empty()) {
    equal_.fill(tile.label);
    return {equal_.data(), 0, 0};
  }
  const std::size_t row = tile.size[0], slice = row * tile.size[1];
  return {&tile.labels[(cube[2] % kCubes * kCubeEdge) * slice + (cube[1] % kCubes * kCubeEdge) * row +
                       cube[0] % kCubes * kCubeEdge],
          row, slice};
}

}  // namespace gs::qnv::values
