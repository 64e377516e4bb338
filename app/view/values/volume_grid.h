#pragma once

#include "app/formats/volume/volume.h"
#include "qnv/sampling/volume/volume.h"

#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

/// Values of a volume in memory. A large volume keeps only every second or third voxel per axis.
class VolumeGrid {
 public:
  static constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 27;  // max kept voxels

  /// Reads a volume file. A true `stop` cancels it. Runs on any thread; errors name the file. Memory is charged to
  /// `budget`.
  [[nodiscard]] static std::variant<std::shared_ptr<const VolumeGrid>, std::string> read(
      const std::string& path, const std::atomic<bool>* stop = nullptr, const WorldBudget& budget = own_budget(),
      std::uint64_t most_voxels = kMaxVoxels);
  /// Reads from a source; see `read`.
  [[nodiscard]] static std::variant<std::shared_ptr<const VolumeGrid>, std::string> take(
      const qnv::VolumeSource& source, const std::atomic<bool>* stop, const WorldBudget& budget,
      std::uint64_t most_voxels);

  /// Returns the dimensions of the file, not of the kept voxels.
  [[nodiscard]] const std::array<std::uint32_t, 3>& dimensions() const { return layout_.dimensions; }
  [[nodiscard]] const qnv::VolumeLayout& layout() const { return layout_; }
  /// Stride of kept voxels; 1 means all.
  [[nodiscard]] std::uint32_t step() const { return step_; }
  /// Returns the minimum and maximum value.
  [[nodiscard]] std::pair<float, float> value_range() const { return range_; }

  /// Convert between the file's space and voxel coordinates, with 0 at the centre of the first voxel. Positions may lie
  /// outside.
  [[nodiscard]] glm::dvec3 voxel_at(const glm::dvec3& place) const;
  [[nodiscard]] glm::dvec3 place_of(const glm::dvec3& voxel) const;
  /// Returns the value of the nearest kept voxel. Returns nullopt if the position is over half a voxel outside, or the
  /// value is missing.
  [[nodiscard]] std::optional<float> nearest(const glm::dvec3& voxel) const;
  /// Returns the number of kept voxels along an axis.
  [[nodiscard]] std::uint32_t kept(std::size_t axis) const { return kept_[axis]; }
  /// Returns a kept value; kMissing if the value is missing.
  [[nodiscard]] float kept_value(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return values_[(std::size_t{z} * kept_[1] + y) * kept_[0] + x];
  }

 private:
  VolumeGrid() = default;
  qnv::VolumeLayout layout_;
  std::array<std::uint32_t, 3> kept_{};
  std::uint32_t step_ = 1;
  std::pair<float, float> range_{0, 1};
  std::vector<float> values_;
  std::optional<Share> share_;
};

}  // namespace gs::app
