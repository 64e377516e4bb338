#pragma once

#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume_values.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Function that takes the next bytes of a file. It returns false to stop.
using TakeBytes = std::function<bool(std::span<const std::byte>)>;

/// Form of the written numbers.
struct VoxelForm {
  bool scaled = true;  // the format has slope and intercept; otherwise scaled values become float32
  bool big_endian = false;
  bool fits_types = false;  // FITS has u8, i16 and i32; other integers are shifted by half of their range
  bool planes = false;      // each component is contiguous; otherwise the numbers of a voxel are
};

/// Voxels to write: their layout with type, byte order, slope, intercept and missing value of the numbers.
class WrittenVoxels {
 public:
  /// Returns a message if the geometry has no values, or not the finest ones. `geometry` must outlive the result.
  [[nodiscard]] static std::variant<WrittenVoxels, std::string> of(const qnv::Geometry& geometry,
                                                                   const VoxelForm& form);

  [[nodiscard]] const qnv::VolumeLayout& layout() const { return layout_; }
  /// Returns the numbers per voxel.
  [[nodiscard]] std::size_t components() const { return components_; }
  /// Returns the times of the steps of a time series; empty for a single volume.
  [[nodiscard]] const std::vector<double>& times() const { return times_; }
  /// Reports whether the components are colours. Each voxel then has its numbers together.
  [[nodiscard]] bool colors() const { return layout_.colors; }
  /// Returns the number of bytes of all voxels.
  [[nodiscard]] std::uint64_t bytes() const;
  /// Converts the voxels slice by slice. Returns a message if a slice cannot be read, and an empty message if `take`
  /// stops.
  [[nodiscard]] std::optional<std::string> write(const TakeBytes& take) const;

 private:
  WrittenVoxels() = default;
  /// Adds the components of a volume. Returns a message if they differ.
  [[nodiscard]] std::optional<std::string> add(const qnv::VolumeValues& values);
  /// Converts a slice of a part. Returns a message if it cannot be read.
  [[nodiscard]] std::optional<std::string> convert(std::size_t part, std::uint32_t z, std::vector<std::byte>& to) const;
  /// Writes slice z of a step, with the numbers of a voxel together.
  [[nodiscard]] std::optional<std::string> write_joined(std::size_t step, std::uint32_t z, const TakeBytes& take) const;

  std::vector<const qnv::VolumeValues*> parts_;  // by step, then by component
  std::size_t components_ = 0;
  std::vector<double> times_;
  qnv::VolumeLayout layout_;
  VoxelForm form_;
  double offset_ = 0;  // of the numbers of FITS
};

}  // namespace gs::app
