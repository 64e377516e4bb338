#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/lossless/cover.h"
#include "qnv/codecs/lossless/decode/shaded_mesh.h"
#include "qnv/codecs/lossless/decode/tail_reader.h"
#include "qnv/codecs/lossless/exact_mesh.h"
#include "qnv/codecs/lossless/low_bits.h"
#include "qnv/codecs/lossless/picture.h"
#include "qnv/codecs/lossless/tail_pieces.h"
#include "qnv/codecs/shared/decoder.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Exact mesh at the end of a stream. It grows triangle by triangle while its tail is received. If the table of covered
/// patches is received, the partial mesh is drawn together with the patches that are not covered. One thread at a time.
/// Safe for untrusted bytes.
class ExactSurface {
 public:
  /// `box` is the box of the stream.
  ExactSurface(const Box& box, std::size_t most_vectors) : box_(box), most_vectors_(most_vectors) {}

  /// Adds the payload of a chunk: of the tail, its low bits, its table of covered patches, its texture or its normals.
  /// Any order.
  void add(ChunkType type, std::span<const std::byte> payload);
  /// Reports whether the whole mesh can be drawn. Its positions and texture may still be refined.
  [[nodiscard]] bool whole() const { return mesh_ && dressed(); }
  /// Returns the table of covered patches if a part of the mesh can be drawn; otherwise nullptr.
  [[nodiscard]] const exact::Cover* cover() const;
  /// Returns the number of triangles received.
  [[nodiscard]] std::size_t triangles() const {
    return mesh_ ? mesh_->triangles.size() : reader_ ? reader_->triangles() : 0;
  }
  /// Appends the received vertices, duplicated at creases, and their triangles. `colored` appends colours; a mesh
  /// without colours uses the colour of `mesh`.
  void append(IndexedMesh& mesh, bool colored) const;
  [[nodiscard]] MeshProgress progress() const;
  /// Returns the number of drawn vertices.
  [[nodiscard]] std::size_t vectors() const { return triangles() > 0 ? shown().positions.size() : 0; }
  [[nodiscard]] const DecodeCount& count() const { return count_; }

 private:
  void add_tail(std::span<const std::byte> payload);
  void add_shading(std::span<const std::byte> payload);
  /// Adds the low bits of positions.
  void add_low_bits(std::span<const std::byte> payload);
  /// Adds the table of covered patches.
  void add_cover(std::span<const std::byte> payload);
  /// Adds a part of the texture. A textured mesh is drawn only with its texture.
  void add_picture(std::span<const std::byte> payload);
  /// Adds a part of the normals that the stream contains. The normals are used when the tail and all normals are
  /// received.
  void add_normals(std::span<const std::byte> payload);
  /// Reports whether no later chunk can refine the mesh.
  [[nodiscard]] bool finest() const;
  /// Decodes the normals that the stream contains, if the tail and all normals are received.
  void read_normals();
  /// Returns the drawn vertices; recomputes them after changes.
  [[nodiscard]] const IndexedMesh& shown() const;
  [[nodiscard]] bool textured() const { return mesh_ ? mesh_->texture.bits > 0 : reader_ && reader_->textured(); }
  /// Reports whether the received part can be drawn: a textured mesh also needs enough of its texture.
  [[nodiscard]] bool dressed() const { return !textured() || picture_.enough(); }

  exact::TailPieces pieces_;
  std::optional<exact::TailReader> reader_;  // null after the tail is complete
  std::optional<exact::ExactMesh> mesh_;  // null until the tail is complete
  std::optional<exact::Cover> cover_;
  std::optional<exact::Shading> shading_;
  exact::LowBits low_bits_;
  exact::PictureReader picture_;
  exact::TailPieces normal_pieces_;
  std::vector<std::byte> normal_bytes_;  // empty after the tail is complete
  mutable std::vector<glm::vec3> own_normals_;  // one per corner; if empty, the shading rule applies
  Box box_;
  std::size_t most_vectors_;
  bool done_ = false;
  DecodeCount count_;
  mutable std::optional<IndexedMesh> shown_;
};

}  // namespace gs::qnv
