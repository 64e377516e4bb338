#pragma once

#include "qnv/base/geometry.h"
#include "qnv/codecs/values/decode/sample_bricks.h"
#include "qnv/codecs/values/decode/sample_limits.h"
#include "qnv/sampling/volume/volume.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::qnv {
struct GradientRow;
}

namespace gs::qnv::values {

/// Selection of the vectors of CellVectors.
struct CellVectorOptions {
  double fraction = 0.09;               // of the voxels; at most round(fraction * voxels) vectors
  std::uint64_t most = 1;               // maximum number of vectors
  std::pair<float, float> range{0, 1};  // values of classes 0 and 255
};

/// Samples of a level with their layout. Reads boxes of values.
struct SampledGrid {
  SampleBricks samples;
  VolumeLayout layout;                                         // of i32 samples
  std::shared_ptr<const std::vector<std::uint8_t>> missing{};  // 1 marks a missing voxel; or null

  SampleLimits limits{};

  /// Reads stored numbers, within the limits. Missing voxels become `layout.missing`.
  void read(const SampleBox& box, std::int32_t* to) const;
};

/// Longest gradient vectors of a level, in cells of 8 voxels per axis. After changes of some samples, computes only the
/// vectors of cells that they reach. The gradients have the same bits as those of gradient_vectors(). The result does
/// not depend on earlier states or threads.
class CellVectors {
 public:
  CellVectors(Extent extent, const glm::dmat3& axes, const CellVectorOptions& options);

  /// Computes the vectors again around the samples in `changed`.
  void update(const SampledGrid& grid, std::span<const SampleBox> changed);
  /// Writes the vectors to a volume, which must be empty, longest first: the binary logarithms of lengths out of order
  /// differ by at most 1/128. Vectors of about equal length are in the order of their cells.
  void fill(const SampledGrid& grid, Volume& volume) const;
  /// Returns the sum of all lengths, including those of omitted vectors.
  [[nodiscard]] double total() const;

 private:
  static constexpr std::uint32_t kCell = 8;
  // Bits of a float >= 0, which sort like the floats; the upper 15 bits after the sign.
  static constexpr unsigned kLowerBits = 16;
  static constexpr std::size_t kKeys = std::size_t{1} << (31 - kLowerBits);
  using Counts = std::vector<std::int64_t>;
  struct Vector {
    std::uint16_t place = 0;   // in its cell
    std::uint32_t length = 0;  // bits of the float
    float value = 0;
    glm::vec3 normal{0};
  };
  struct Cell {
    double total = 0;
    std::vector<Vector> vectors;  // with a key of at least `lowest_`
  };
  class Rows;
  /// Minimum length of the vectors in the result.
  struct Cut {
    std::uint32_t key = 1;     // of the minimum
    std::uint32_t length = 0;  // bits; shorter vectors are dropped
    std::uint64_t ties = 0;    // number of vectors with exactly that length in the result
    std::uint64_t count = 0;   // vectors of the result
  };

  [[nodiscard]] std::size_t cell_of(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return (std::size_t{z / kCell} * cells_[1] + y / kCell) * cells_[0] + x / kCell;
  }
  void measure(const SampledGrid& grid, std::span<const SampleBox> boxes);
  void measure_box(const Rows& rows, const SampleBox& box, Counts& counts);
  void collect(const SampledGrid& grid, std::span<const SampleBox> boxes);
  /// Takes the vectors of a row. `lengths` are those of its gradients in the box, or null.
  void collect_row(const Rows& rows, const GradientRow& row, const float* lengths, const SampleBox& box,
                   std::uint32_t y, std::uint32_t z);
  [[nodiscard]] std::uint64_t wanted() const;
  /// Returns the largest key that at least `count` vectors reach, or 1.
  [[nodiscard]] std::uint32_t key_of(std::uint64_t count) const;
  [[nodiscard]] Cut cut() const;

  const Extent extent_;
  Extent cells_{};
  glm::dmat3 to_world_;
  const CellVectorOptions options_;
  std::vector<std::uint16_t> keys_;  // of all voxels; 0 means no vector
  Counts counts_;                    // of the keys
  std::vector<Cell> all_;
  std::uint32_t lowest_ = 0;  // 0 means that no vectors were collected
};

}  // namespace gs::qnv::values
