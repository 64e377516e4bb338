#pragma once

#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/codecs/progressive/split_growth.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv::progressive {

/// Encoded progressive mesh: it starts coarse and becomes exact vertex by vertex. The front belongs into the stream's
/// header; each segment is the payload of a chunk.
struct ProgressiveBytes {
  std::vector<std::byte> front;
  std::vector<std::vector<std::byte>> segments;
  std::size_t vertices = 0;  // number of vertices of the complete mesh
};

/// Encodes a mesh without colours that exact::quantized() returned. Returns nullopt if the front cannot be encoded in
/// `most_front` bytes.
[[nodiscard]] std::optional<ProgressiveBytes> encode_progressive(const exact::ExactMesh& mesh, std::size_t most_front);

/// Reports whether a header section starts like a front. Also distinguishes a front from a damaged first stage of a
/// displaced surface.
[[nodiscard]] bool is_front(std::span<const std::byte> section);

/// Reports whether a header section is the front of a mesh with more than `most_vertices` vertices.
[[nodiscard]] bool promises_more(std::span<const std::byte> section, std::size_t most_vertices);

/// Received progressive mesh. A segment waits until all earlier segments are received. One thread at a time. Safe for
/// untrusted bytes: memory is proportional to the number of bytes.
class ProgressiveMesh {
 public:
  /// Starts from a front. Returns false if the bytes are not a front, or if the mesh would have more than
  /// `most_vertices` vertices.
  bool begin(std::span<const std::byte> front, std::size_t most_vertices);
  [[nodiscard]] bool begun() const { return growth_.has_value(); }
  /// Adds a segment: the payload of a chunk. Returns false if it is invalid.
  bool add(std::span<const std::byte> payload);
  /// Reports whether the mesh is complete and exact.
  [[nodiscard]] bool whole() const;
  [[nodiscard]] int bits() const { return bits_; }
  /// Returns the number of segments decoded so far.
  [[nodiscard]] std::size_t segments() const { return next_; }
  [[nodiscard]] std::size_t vertices() const { return growth_ ? growth_->size() : 0; }
  /// Returns the mesh decoded so far, on the finest lattice.
  [[nodiscard]] exact::ExactMesh mesh() const;

 private:
  bool read(std::span<const std::byte> payload);

  std::optional<SplitGrowth> growth_;
  int bits_ = 0;
  exact::Shading shading_;
  std::uint32_t vertices_ = 0, triangles_ = 0;
  std::size_t next_ = 0, waiting_bytes_ = 0;
  bool broken_ = false;  // a segment was invalid, so all later ones are useless
  std::map<std::size_t, std::vector<std::byte>> waiting_;  // segments by index
};

}  // namespace gs::qnv::progressive
