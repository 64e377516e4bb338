#pragma once

#include "qnv/base/cloud.h"
#include "qnv/decode/shaded_mesh.h"
#include "qnv/exact/exact_mesh.h"
#include "qnv/exact/tail_pieces.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// The mesh at the end of a displaced stream: nothing until all of its tail has come, then as it was. One thread; safe
/// for untrusted bytes.
class ExactSurface {
 public:
  struct Count {
    std::size_t vectors = 0, refused = 0, taken = 0;
    bool full = false;  // it was left out because of `most_vectors`
  };

  /// The payload of a chunk. `box`: of the stream.
  void add(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors);
  /// That of one that says how it is shaded; it may come behind the tail.
  void add_shading(std::span<const std::byte> payload, const Box& box, std::size_t most_vectors);
  /// Whether it is there.
  [[nodiscard]] bool whole() const { return whole_; }
  /// How many bytes of the tail have come, and how many there are; 0: none have.
  [[nodiscard]] std::size_t come() const { return pieces_.come(); }
  [[nodiscard]] std::size_t length() const { return pieces_.length(); }
  /// Places an axis, as a power of two; 0: it is not there.
  [[nodiscard]] int bits() const { return bits_; }
  /// Its vertices, one a side where it has a crease, and the triangles between them. `colored`: they have colours, that
  /// of the cloud where it has none.
  void append(Cloud& cloud, bool colored) const;
  [[nodiscard]] const Count& count() const { return count_; }

 private:
  void make(const Box& box, std::size_t most_vectors);

  exact::TailPieces pieces_;
  std::vector<std::byte> tail_;  // once all of it has come
  std::optional<exact::Shading> shading_;
  bool whole_ = false, done_ = false;
  int bits_ = 0;
  Count count_;
  ShadedVertices shown_;
};

}  // namespace gs::qnv
