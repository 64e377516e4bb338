#pragma once

#include "base/budget.h"
#include "base/parallel.h"
#include "qnv/sampling/volume/volume.h"

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Vectors of a volume in memory. A large volume is thinned to every second, third, ... voxel along each axis.
class VectorField {
 public:
  static constexpr std::uint64_t kMaxVectors = std::uint64_t{1} << 22;

  /// Reads the first three components of a volume with at least two; the third one is 0 for two. Returns a message on
  /// failure. The memory counts against `budget`.
  [[nodiscard]] static std::variant<VectorField, std::string> read(const qnv::VolumeSource& source,
                                                                   const WorldBudget& budget, const Progress& progress,
                                                                   std::uint64_t most = kMaxVectors);

  /// Returns the stored vectors along each axis.
  [[nodiscard]] const std::array<std::uint32_t, 3>& size() const { return size_; }
  /// Returns a stored vector; NaN if the value is missing.
  [[nodiscard]] const glm::vec3& at(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return vectors_[(std::size_t{z} * size_[1] + y) * size_[0] + x];
  }
  /// Returns the position of a stored vector, or of a place between vectors, in the space of the volume.
  [[nodiscard]] glm::dvec3 position(const glm::dvec3& place) const { return origin_ + axes_ * place; }
  /// Interpolates the vector at a place, in units of stored vectors. Returns nullopt outside and near missing values.
  [[nodiscard]] std::optional<glm::dvec3> interpolated(const glm::dvec3& place) const;
  /// Converts a vector in the space of the volume to units of stored vectors.
  [[nodiscard]] glm::dvec3 in_steps(const glm::dvec3& vector) const { return inverse_ * vector; }
  /// Returns the smallest distance of stored vectors along an axis with several.
  [[nodiscard]] double spacing() const;
  /// Returns the approximate quantile `part`, 0 to 1, of the lengths of all vectors.
  [[nodiscard]] double length_at(double part) const;

 private:
  VectorField() = default;
  std::array<std::uint32_t, 3> size_{};
  std::vector<glm::vec3> vectors_;
  glm::dvec3 origin_{0};
  glm::dmat3 axes_{1}, inverse_{1};
  std::optional<Share> share_;
};

}  // namespace gs::app
