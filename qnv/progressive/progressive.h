#pragma once

#include "qnv/exact/exact_mesh.h"
#include "qnv/progressive/split_growth.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::progressive {

/// A mesh that begins coarse and becomes itself vertex by vertex: the front stands in the header of a stream, the
/// segments are payloads of chunks.
struct ProgressiveBytes {
  std::vector<std::byte> front;
  std::vector<std::vector<std::byte>> segments;
  std::size_t vertices = 0;  // in the end
};

/// `mesh`: as exact::quantized gives it, without colours. The front has at most so many bytes; nothing where that
/// cannot be.
[[nodiscard]] std::optional<ProgressiveBytes> encode_progressive(const exact::ExactMesh& mesh, std::size_t most_front);

/// Whether a section of the header is such a front, and one of more than so many vertices.
[[nodiscard]] bool promises_more(std::span<const std::byte> section, std::size_t most_vertices);

/// The mesh as it comes. Segments that come before their time wait. One thread; safe for untrusted bytes: memory is in
/// proportion to them.
class ProgressiveMesh {
 public:
  /// False where the bytes are no front, or promise more than `most_vertices`.
  bool begin(std::span<const std::byte> front, std::size_t most_vertices);
  [[nodiscard]] bool begun() const { return growth_.has_value(); }
  /// The payload of a chunk. False where it is none.
  bool add(std::span<const std::byte> payload);
  /// Whether all of it is there, to the last bit.
  [[nodiscard]] bool whole() const;
  [[nodiscard]] int bits() const { return bits_; }
  /// Segments that have been read.
  [[nodiscard]] std::size_t segments() const { return next_; }
  [[nodiscard]] std::size_t vertices() const { return growth_ ? growth_->size() : 0; }
  /// What there is of it, on the finest lattice.
  [[nodiscard]] exact::ExactMesh mesh() const;

 private:
  bool read(std::span<const std::byte> payload);

  std::optional<SplitGrowth> growth_;
  int bits_ = 0;
  exact::Shading shading_;
  std::uint32_t vertices_ = 0, triangles_ = 0;
  std::size_t next_ = 0, waiting_bytes_ = 0;
  bool broken_ = false;  // a segment was none: what follows it cannot be read
  std::map<std::size_t, std::vector<std::byte>> waiting_;  // by number
};

}  // namespace gs::qnv::progressive
