#pragma once

#include "app/formats/volume/volume.h"
#include "qnv/sampling/volume/volume.h"
#include "qnv/sampling/volume/volume_values.h"

#include <glm/vec3.hpp>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app {

/// Values of a volume in memory. For a large volume, only every second or third voxel along each axis is stored.
class VolumeGrid {
 public:
  static constexpr std::uint64_t kMaxVoxels = std::uint64_t{1} << 27;  // max voxels in memory

  /// Reads a volume file. Setting `stop` to true cancels this. Returns an error message that names the file on failure.
  /// The memory counts against `budget`. Any thread.
  [[nodiscard]] static std::variant<std::shared_ptr<const VolumeGrid>, std::string> read(
      const std::string& path, const std::atomic<bool>* stop = nullptr, const WorldBudget& budget = own_budget(),
      std::uint64_t most_voxels = kMaxVoxels, const VoxelComponent& component = {});
  /// Reads the values from a source; otherwise like read(). `about` has the properties of a stream's values, and finer
  /// parts of them.
  [[nodiscard]] static std::variant<std::shared_ptr<const VolumeGrid>, std::string> take(
      const qnv::VolumeSource& source, const std::atomic<bool>* stop, const WorldBudget& budget,
      std::uint64_t most_voxels, const qnv::VolumeValues* about = nullptr);

  /// Returns the dimensions of the values, in voxels.
  [[nodiscard]] const std::array<std::uint32_t, 3>& dimensions() const { return layout_.dimensions; }
  /// Returns the dimensions of the whole volume. Values of a stream may be coarser.
  [[nodiscard]] const std::array<std::uint32_t, 3>& whole() const { return whole_; }
  /// Returns the number of voxels of the whole volume per voxel of the values: a power of two.
  [[nodiscard]] std::uint32_t fineness(std::size_t axis) const { return fineness_[axis]; }
  [[nodiscard]] const qnv::VolumeLayout& layout() const { return layout_; }
  /// Returns the distance between stored voxels in voxels of the file; 1 means that all are stored.
  [[nodiscard]] std::uint32_t step() const { return step_; }
  /// Returns the minimum and the maximum value, or the given ones.
  [[nodiscard]] std::pair<float, float> value_range() const { return range_; }

  /// Converts a position in the space of the file to voxel coordinates, in which 0 is the centre of the first voxel.
  /// place_of() does the reverse. Positions may be outside of the volume.
  [[nodiscard]] glm::dvec3 voxel_at(const glm::dvec3& place) const;
  [[nodiscard]] glm::dvec3 place_of(const glm::dvec3& voxel) const;
  /// Returns the value of the nearest stored voxel, or of that of the finest part there. Returns nullopt if the
  /// position is more than half a voxel outside of the volume, or if the value is missing.
  [[nodiscard]] std::optional<float> nearest(const glm::dvec3& voxel) const;
  /// Returns the maximum error of the value of nearest(), in the unit of the values; nullopt if it is unknown.
  [[nodiscard]] std::optional<float> error_at(const glm::dvec3& voxel) const;
  /// Returns the colour of the nearest stored voxel: red, green, blue, opacity. Returns nullopt if the position is more
  /// than half a voxel outside of the volume, or if the volume has no colours.
  [[nodiscard]] std::optional<std::array<std::uint8_t, 4>> color_at(const glm::dvec3& voxel) const;
  [[nodiscard]] bool has_colors() const { return !colors_.empty(); }
  /// Returns the parts with finer values than the stored voxels, the finest first.
  [[nodiscard]] const std::vector<qnv::ValueBrick>& bricks() const { return bricks_; }
  /// Returns the label that a value stands for. If a label exceeds the whole numbers of float, values are indices of
  /// labels.
  [[nodiscard]] double label_of(float value) const;
  /// Returns the number of stored voxels along an axis.
  [[nodiscard]] std::uint32_t kept(std::size_t axis) const { return kept_[axis]; }
  /// Returns the value of a stored voxel, by its index among the stored ones; kMissing if the value is missing.
  [[nodiscard]] float kept_value(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return values_[(std::size_t{z} * kept_[1] + y) * kept_[0] + x];
  }
  /// Returns the colour of a stored voxel. The volume must have colours.
  [[nodiscard]] const std::array<std::uint8_t, 4>& kept_color(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    return colors_[(std::size_t{z} * kept_[1] + y) * kept_[0] + x];
  }
  /// Returns the stored voxels of a slice, x first.
  [[nodiscard]] std::span<const float> kept_slice(std::uint32_t z) const {
    const std::size_t size = std::size_t{kept_[0]} * kept_[1];
    return std::span(values_).subspan(z * size, size);
  }

 private:
  /// Sample of a finer part.
  struct FineSample {
    const qnv::ValueBrick* brick = nullptr;
    std::array<std::uint32_t, 3> at{};
  };
  VolumeGrid() = default;
  /// Takes the properties of a stream's values.
  void describe(const qnv::VolumeValues& about);
  /// Returns the sample of the finest part that is nearest to a position in the volume; a null brick if there is none.
  [[nodiscard]] FineSample fine_sample(const glm::dvec3& voxel) const;
  /// Returns the indices of the nearest stored voxel; nullopt outside of the volume.
  [[nodiscard]] std::optional<std::array<std::uint32_t, 3>> kept_at(const glm::dvec3& voxel) const;
  /// Reads the colours. Returns false if the source fails.
  bool read_colors(const qnv::VolumeSource& source);
  /// Replaces the values by indices of labels. Returns false if the source fails.
  bool number_labels(const qnv::VolumeSource& source);
  qnv::VolumeLayout layout_;
  std::array<std::uint32_t, 3> kept_{}, whole_{}, fineness_{1, 1, 1};
  std::uint32_t step_ = 1;
  std::pair<float, float> range_{0, 1};
  std::vector<float> values_;
  std::vector<std::array<std::uint8_t, 4>> colors_;  // red, green, blue, opacity; empty without colours
  std::vector<qnv::ValueBrick> bricks_;
  std::optional<float> error_;
  std::vector<double> labels_;  // of the values, which are then indices; ascending
  std::optional<Share> share_;
};

/// Returns every `stride`th stored voxel of a grid as a volume, which shares the ownership of the grid.
[[nodiscard]] qnv::VolumeSource source_of(const std::shared_ptr<const VolumeGrid>& grid, std::uint32_t stride = 1);

}  // namespace gs::app
