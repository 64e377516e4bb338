#pragma once

#include "qnv/base/cloud.h"
#include "qnv/decode/shaded_mesh.h"
#include "qnv/exact/cover.h"
#include "qnv/exact/exact_mesh.h"
#include "qnv/exact/low_bits.h"
#include "qnv/exact/picture.h"
#include "qnv/exact/tail_pieces.h"
#include "qnv/exact/tail_reader.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// The mesh at the end of a displaced stream. It grows triangle by triangle as its tail comes; once a table says which
/// patches of a stage it covers, what is there of it can be shown beside the others. One thread; safe for untrusted
/// bytes.
class ExactSurface {
 public:
  struct Count {
    std::size_t refused = 0, taken = 0;
    bool full = false;  // it was left out because of `most_vectors`
  };

  /// The payload of a chunk. `box`: of the stream.
  void add(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors);
  /// That of one that says how it is shaded; it may come behind the tail.
  void add_shading(std::span<const std::byte> payload);
  /// The bits of finer lattices; they may come before the tail.
  void add_low_bits(std::span<const std::byte> payload);
  /// The table of what patches it covers; it may come behind the tail.
  void add_cover(std::span<const std::byte> payload);
  /// The picture of a textured mesh, without which it is not shown; it may come before the tail.
  void add_picture(std::span<const std::byte> payload);
  /// Normals that are its own; they may come before the tail, and are used once it and all of them are there.
  void add_normals(std::span<const std::byte> payload);
  /// Whether it is there; its places and its picture may still become finer.
  [[nodiscard]] bool whole() const { return mesh_ && dressed(); }
  /// The patches that are covered, where some of it is there and not all; null: it is nothing yet.
  [[nodiscard]] const exact::Cover* cover() const;
  /// How many triangles have come.
  [[nodiscard]] std::size_t triangles() const {
    return mesh_ ? mesh_->triangles.size() : reader_ ? reader_->triangles() : 0;
  }
  /// Whether they are as fine as they will be.
  [[nodiscard]] bool finest() const;
  /// How many bytes of the tail have come, and how many there are; 0: none have.
  [[nodiscard]] std::size_t come() const { return pieces_.come(); }
  [[nodiscard]] std::size_t length() const { return pieces_.length(); }
  /// Places an axis, as a power of two; 0: it is not there.
  [[nodiscard]] int bits() const { return mesh_ ? std::max(mesh_->bits, mesh_->finest) : 0; }
  /// The vertices that have come, one a side where it has a crease, and the triangles between them. `colored`: they
  /// have colours, that of the cloud where it has none.
  void append(Cloud& cloud, bool colored) const;
  /// How many bytes of the picture have come, and how many there are; 0: none have.
  [[nodiscard]] std::size_t picture_come() const { return picture_.come(); }
  [[nodiscard]] std::size_t picture_length() const { return picture_.length(); }
  /// How many vertices it is shown with.
  [[nodiscard]] std::size_t vectors() const { return triangles() > 0 ? shown().positions.size() : 0; }
  [[nodiscard]] const Count& count() const { return count_; }

 private:
  /// Works them out once all is there that it takes.
  void read_normals();
  /// Made anew when something came since the last time.
  [[nodiscard]] const ShadedVertices& shown() const;
  [[nodiscard]] bool textured() const { return mesh_ ? mesh_->texture.bits > 0 : reader_ && reader_->textured(); }
  /// Whether there is what it takes to show what has come of it.
  [[nodiscard]] bool dressed() const { return !textured() || picture_.enough(); }

  exact::TailPieces pieces_;
  std::optional<exact::TailReader> reader_;  // until all of it has come
  std::optional<exact::ExactMesh> mesh_;     // from then on
  std::optional<exact::Cover> cover_;
  std::optional<exact::Shading> shading_;
  exact::LowBits low_bits_;
  exact::PictureReader picture_;
  exact::TailPieces normal_pieces_;
  std::vector<std::byte> normal_bytes_;         // until the tail is there
  mutable std::vector<glm::vec3> own_normals_;  // of corners; none: by the rule of its shading
  Box box_;
  std::size_t most_vectors_ = 0;
  bool done_ = false;
  Count count_;
  mutable std::optional<ShadedVertices> shown_;
};

}  // namespace gs::qnv
