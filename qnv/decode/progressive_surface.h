#pragma once

#include "qnv/decode/shaded_mesh.h"
#include "qnv/progressive/progressive.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace gs::qnv {

/// A mesh that becomes finer as it comes, as it is shown. One thread; safe for untrusted bytes.
class ProgressiveSurface {
 public:
  struct Count {
    std::size_t refused = 0, taken = 0;
    bool full = false;  // it was left out because of `most_vectors`
  };

  /// The section of the header. `box`: of the stream. False where it is none.
  [[nodiscard]] bool begin(std::span<const std::byte> front, const Box& box, std::size_t most_vectors);
  [[nodiscard]] bool begun() const { return mesh_.begun(); }
  /// The payload of a chunk.
  void add(std::span<const std::byte> payload);
  [[nodiscard]] const progressive::ProgressiveMesh& mesh() const { return mesh_; }
  /// As far as it has come; made anew when something came since the last time.
  [[nodiscard]] const ShadedVertices& shown() const;
  [[nodiscard]] const Count& count() const { return count_; }

 private:
  progressive::ProgressiveMesh mesh_;
  Box box_;
  Count count_;
  mutable std::optional<ShadedVertices> shown_;
};

}  // namespace gs::qnv
