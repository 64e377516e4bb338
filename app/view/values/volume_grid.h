#pragma once

#include "app/formats/volume/volume.h"
#include "qnv/volume/volume.h"

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

/// The values of a volume in memory, of one that is too large every second voxel, or third, each way.
class VolumeGrid {
 public:
  static constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 27;  // that are kept

  /// Reads a volume's file. `stop`: true ends it. Any thread; errors name the file. What it takes is drawn from
  /// `budget`.
  [[nodiscard]] static std::variant<std::shared_ptr<const VolumeGrid>, std::string> read(
      const std::string& path, const std::atomic<bool>* stop = nullptr, const WorldBudget& budget = own_budget(),
      std::uint64_t most_voxels = kMostVoxels);
  /// Of a source; see `read`.
  [[nodiscard]] static std::variant<std::shared_ptr<const VolumeGrid>, std::string> take(
      const qnv::VolumeSource& source, const std::atomic<bool>* stop, const WorldBudget& budget,
      std::uint64_t most_voxels);

  /// Of the file, not of what is kept.
  [[nodiscard]] const std::array<std::uint32_t, 3>& dimensions() const { return layout_.dimensions; }
  [[nodiscard]] const qnv::VolumeLayout& layout() const { return layout_; }
  /// Every so manieth voxel is kept; 1: all.
  [[nodiscard]] std::uint32_t step() const { return step_; }
  /// The least and the largest value.
  [[nodiscard]] std::pair<float, float> value_range() const { return range_; }

  /// Voxels of the file at a place of the file's space, from 0 at the centre of the first one; outside too.
  [[nodiscard]] glm::dvec3 voxel_at(const glm::dvec3& place) const;
  [[nodiscard]] glm::dvec3 place_of(const glm::dvec3& voxel) const;
  /// The value of the voxel that is kept and nearest to this one; nothing where it lies outside by more than half a
  /// voxel, or is missing.
  [[nodiscard]] std::optional<float> nearest(const glm::dvec3& voxel) const;
  /// Between the voxels, linear; nothing outside of the centres of the outer ones, or beside a missing one.
  [[nodiscard]] std::optional<float> between(const glm::dvec3& voxel) const;
  /// What is kept of one axis.
  [[nodiscard]] std::uint32_t kept(std::size_t axis) const { return kept_[axis]; }
  /// A value that is kept; kMissing where it is missing.
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
  std::optional<vrml::Share> share_;
};

}  // namespace gs::app
