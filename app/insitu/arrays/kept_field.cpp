#include "app/insitu/arrays/kept_field.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

namespace gs::app::insitu {
namespace {

// Share of the error bound that codes may use. The rest remains for rounding in encode_chunk().
constexpr double kShareOfCodes = 0.25;

// Header of a part of a chunk in a message. The values follow, as floats or as codes.
struct PieceHeader {
  std::uint32_t number = 0;  // index of the chunk in the list
  std::uint32_t exact = 0;
  GridIndex first{}, size{};  // in the chunk
  CodeScale scale;
};

float missing_value() { return std::numeric_limits<float>::quiet_NaN(); }

std::size_t points_in(const GridIndex& size) { return std::size_t{size[0]} * size[1] * size[2]; }

// Copies the rows of a piece to their positions in a chunk.
void place_piece(const PieceHeader& piece, const std::byte* from, const GridIndex& shape, std::vector<float>& to) {
  std::vector<std::int16_t> codes(piece.exact != 0 ? 0 : piece.size[0]);
  for (std::uint32_t z = 0; z < piece.size[2]; ++z)
    for (std::uint32_t y = 0; y < piece.size[1]; ++y) {
      float* const row =
          &to[(std::size_t{piece.first[2] + z} * shape[1] + piece.first[1] + y) * shape[0] + piece.first[0]];
      if (piece.exact != 0) {
        std::memcpy(row, from, piece.size[0] * sizeof(float));
        from += piece.size[0] * sizeof(float);
        continue;
      }
      std::memcpy(codes.data(), from, piece.size[0] * sizeof(std::int16_t));
      from += piece.size[0] * sizeof(std::int16_t);
      dequantise(codes.data(), 1, piece.size[0], piece.scale, row);
    }
}

bool is_inside(const PieceHeader& piece, const GridIndex& shape) {
  for (std::size_t a = 0; a < 3; ++a)
    if (piece.size[a] == 0 || std::uint64_t{piece.first[a]} + piece.size[a] > shape[a]) return false;
  return true;
}

}  // namespace

/// Intersection of a chunk with one part of a field.
struct KeptField::Piece {
  GridIndex first{}, size{};  // in the chunk
  GridIndex from{};           // first point in the part
  std::uint32_t step = 1;     // distance between points, in points of the part

  /// Returns the index of the first point of row (y, z) in a part of this size.
  [[nodiscard]] std::size_t row_in(const GridIndex& part, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{from[2] + z * step} * part[1] + from[1] + std::size_t{y} * step) * part[0] + from[0];
  }
};

template <class Work>
void KeptField::each_piece(const Chunk& chunk, const Work& work) const {
  const GridIndex shape = pyramid_.chunk_shape(chunk.level);
  const std::uint64_t step = std::uint64_t{1} << chunk.level;
  for (const Part& part : parts_) {
    Piece piece;
    piece.step = static_cast<std::uint32_t>(step);
    bool any = true;
    for (std::size_t a = 0; a < 3 && any; ++a) {
      // Indices of points of the level.
      const std::uint64_t first = std::uint64_t{chunk.index[a]} * shape[a];
      const std::uint64_t end = std::min<std::uint64_t>(first + shape[a], pyramid_.size(chunk.level)[a]);
      const std::uint64_t low = part.box.first[a], high = low + part.box.size[a];
      const std::uint64_t begin = std::max(first, (low + step - 1) / step);
      const std::uint64_t last = std::min(end, (high + step - 1) / step);
      any = begin < last;
      if (!any) break;
      piece.first[a] = static_cast<std::uint32_t>(begin - first);
      piece.size[a] = static_cast<std::uint32_t>(last - begin);
      piece.from[a] = static_cast<std::uint32_t>(begin * step - low);
    }
    if (any) work(part, piece);
  }
}

bool KeptField::copy(std::span<const GridPart> parts, const CodeScale& scale) {
  scale_ = scale;
  range_ = {};
  parts_.resize(parts.size());
  std::vector<float> slice;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const GridPart& from = parts[i];
    Part& to = parts_[i];
    to.box = from.box;
    const std::size_t layer = std::size_t{from.box.size[0]} * from.box.size[1], all = layer * from.box.size[2];
    if (exact_) {
      to.values.resize(all);
      std::vector<std::int16_t>().swap(to.codes);  // frees the memory
    } else {
      to.codes.resize(all);
      std::vector<float>().swap(to.values);
    }
    slice.resize(layer);
    for (std::uint32_t z = 0; z < from.box.size[2]; ++z) {
      float* const floats = exact_ ? &to.values[layer * z] : slice.data();
      from.copy_floats(z, floats);
      if (exact_)
        measure(floats, layer, range_);
      else
        quantise(floats, layer, scale, &to.codes[layer * z], range_);
    }
  }
  return exact_ || range_.empty() || (range_.low >= scale.low() && range_.high <= scale.high());
}

void KeptField::keep(std::span<const BlockView> blocks, const StepPlan& plan, const ErrorBound& bound,
                     const FiniteRange& expected) {
  pyramid_ = Pyramid(grid_size(plan.grid, plan.kept_field.of_cells != 0, plan.kept_thinning));
  serial_ = plan.serial;
  const std::vector<GridPart> parts = grid_parts(blocks, plan.kept_field, plan.kept_thinning);
  const auto suffices = [&] { return range_.empty() || error() <= kShareOfCodes * bound.of(range_); };
  exact_ = false;
  if (copy(parts, scale_of(expected)) && suffices()) return;
  if (copy(parts, scale_of(range_)) && suffices()) return;
  exact_ = true;
  (void)copy(parts, {});
}

float KeptField::error() const { return exact_ ? 0 : scale_.quantum / 2; }

std::uint64_t KeptField::bytes() const {
  std::uint64_t all = 0;
  for (const Part& part : parts_)
    all += part.codes.capacity() * sizeof(std::int16_t) + part.values.capacity() * sizeof(float);
  return all;
}

void KeptField::read(const Chunk& chunk, std::uint32_t first, std::span<float> values) const {
  const GridIndex shape = pyramid_.chunk_shape(chunk.level);
  const std::size_t layer = std::size_t{shape[0]} * shape[1];
  const auto end = static_cast<std::uint32_t>(first + values.size() / layer);
  std::ranges::fill(values, missing_value());
  each_piece(chunk, [&](const Part& part, const Piece& piece) {
    const std::uint32_t low = piece.first[2];
    for (std::uint32_t z = first > low ? first - low : 0; z < piece.size[2] && low + z < end; ++z)
      for (std::uint32_t y = 0; y < piece.size[1]; ++y) {
        const std::size_t at = piece.row_in(part.box.size, y, z);
        float* const row =
            &values[(std::size_t{low + z - first} * shape[1] + piece.first[1] + y) * shape[0] + piece.first[0]];
        if (exact_)
          for (std::uint32_t x = 0; x < piece.size[0]; ++x) row[x] = part.values[at + std::size_t{x} * piece.step];
        else
          dequantise(&part.codes[at], piece.step, piece.size[0], scale_, row);
      }
  });
}

void KeptField::pack(const Chunk& chunk, std::uint32_t number, std::vector<std::byte>& message) const {
  const std::size_t value_bytes = exact_ ? sizeof(float) : sizeof(std::int16_t);
  each_piece(chunk, [&](const Part& part, const Piece& piece) {
    const PieceHeader header{number, exact_ ? 1U : 0U, piece.first, piece.size, scale_};
    std::size_t end = message.size();
    message.resize(end + sizeof header + points_in(piece.size) * value_bytes);
    std::memcpy(&message[end], &header, sizeof header);
    end += sizeof header;
    for (std::uint32_t z = 0; z < piece.size[2]; ++z)
      for (std::uint32_t y = 0; y < piece.size[1]; ++y) {
        const std::size_t at = piece.row_in(part.box.size, y, z);
        const std::byte* from = exact_ ? reinterpret_cast<const std::byte*>(&part.values[at])
                                       : reinterpret_cast<const std::byte*>(&part.codes[at]);
        for (std::uint32_t x = 0; x < piece.size[0]; ++x, from += piece.step * value_bytes, end += value_bytes)
          std::memcpy(&message[end], from, value_bytes);
      }
  });
}

namespace {

// Copies the pieces in a message of another rank to their chunks. Returns false if the message is malformed.
bool place_pieces(std::span<const std::byte> message, std::span<const KeptField* const> kept,
                  std::span<const Chunk> chunks, std::vector<std::vector<float>>& made) {
  for (std::size_t at = 0; at < message.size();) {
    PieceHeader piece;
    if (message.size() - at < sizeof piece) return false;
    std::memcpy(&piece, &message[at], sizeof piece);
    at += sizeof piece;
    if (piece.number >= chunks.size() || made[piece.number].empty()) return false;
    const GridIndex shape = kept[piece.number]->pyramid().chunk_shape(chunks[piece.number].level);
    const std::size_t value_bytes = piece.exact != 0 ? sizeof(float) : sizeof(std::int16_t);
    if (!is_inside(piece, shape) || (message.size() - at) / value_bytes < points_in(piece.size)) return false;
    place_piece(piece, &message[at], shape, made[piece.number]);
    at += points_in(piece.size) * value_bytes;
  }
  return true;
}

}  // namespace

bool gather_chunks(Ranks& ranks, std::span<const KeptField* const> kept, std::span<const Chunk> chunks,
                   const std::function<void(std::size_t number, std::vector<float> values)>& deliver) {
  std::vector<std::byte> message;
  std::vector<std::uint64_t> sizes;
  std::vector<std::vector<float>> made;
  bool ready = ranks.attempt("chunks", [&] {
    if (ranks.is_first()) {
      sizes.resize(static_cast<std::size_t>(ranks.count()));
      made.resize(chunks.size());
    }
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      if (!kept[i]) continue;
      if (ranks.is_first()) {
        made[i].resize(kept[i]->pyramid().chunk_points(chunks[i].level));
        kept[i]->read(chunks[i], 0, made[i]);
      } else {
        kept[i]->pack(chunks[i], static_cast<std::uint32_t>(i), message);
      }
    }
  });
  bool all = false;
  if (!ranks.agree(ready, all)) return false;
  if (all) {
    const std::uint64_t own_bytes = message.size();
    if (!ranks.gather(&own_bytes, sizeof own_bytes, sizes.data())) return false;
    ready = ranks.attempt("message", [&] {
      if (ranks.is_first()) message.reserve(*std::ranges::max_element(sizes));
    });
    if (!ranks.agree(ready, all)) return false;
  }
  if (all && !ranks.is_first()) return message.empty() || ranks.send(message.data(), message.size());
  for (int from = 1; all && from < ranks.count(); ++from) {
    message.resize(sizes[static_cast<std::size_t>(from)]);
    if (message.empty()) continue;
    if (!ranks.receive(message.data(), message.size(), from) || !place_pieces(message, kept, chunks, made))
      return false;
  }
  if (!ranks.is_first()) return true;
  const bool delivered = ranks.attempt("deliver", [&] {
    for (std::size_t i = 0; i < chunks.size(); ++i) deliver(i, all ? std::move(made[i]) : std::vector<float>());
  });
  // If memory does not suffice for the delivery, viewers request the chunks again.
  for (std::size_t i = 0; i < chunks.size() && !delivered; ++i) deliver(i, {});
  return true;
}

}  // namespace gs::app::insitu
