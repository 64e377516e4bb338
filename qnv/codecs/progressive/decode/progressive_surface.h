#pragma once

#include "qnv/codecs/lossless/decode/shaded_mesh.h"
#include "qnv/codecs/progressive/progressive.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gs::qnv {

/// Progressive mesh for display. Not thread-safe; safe for untrusted bytes.
class ProgressiveSurface {
 public:
  struct Count {
    std::size_t refused = 0, taken = 0;
    bool full = false;  // dropped because of `most_vectors`
  };

  /// Starts from the header's section. `box` is the stream's. Returns false if the section is not a front.
  [[nodiscard]] bool begin(std::span<const std::byte> front, const Box& box, std::size_t most_vectors);
  [[nodiscard]] bool begun() const { return mesh_.begun(); }
  /// Adds the payload of a chunk.
  void add(std::span<const std::byte> payload);
  [[nodiscard]] const progressive::ProgressiveMesh& mesh() const { return mesh_; }
  /// Returns the mesh received so far; recomputes it after changes.
  [[nodiscard]] const ShadedVertices& shown() const;
  [[nodiscard]] const Count& count() const { return count_; }

 private:
  progressive::ProgressiveMesh mesh_;
  Box box_;
  Count count_;
  mutable std::optional<ShadedVertices> shown_;
};

}  // namespace gs::qnv
