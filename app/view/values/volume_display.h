#pragma once

#include "qnv/codecs/values/values_vectors.h"

#include <glm/vec3.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Way to draw a volume.
enum class VolumeMode : std::uint8_t {
  vectors,  // gradient vectors with the transfer function
  maximum,  // projections: maximum, minimum or average of the values along each ray
  minimum,
  average,
};

/// Row of the table of modes.
struct VolumeModeRow {
  VolumeMode mode;
  std::string_view name;  // in options: "maximum"
  std::string_view label;
  std::string_view help;
};
[[nodiscard]] std::span<const VolumeModeRow> volume_modes();
[[nodiscard]] const VolumeModeRow* find_volume_mode(std::string_view name);

/// Limits of VolumeDisplay::share.
inline constexpr float kLeastShare = 0.005f, kMostShare = 0.5f;
inline constexpr auto kUsualShare = static_cast<float>(qnv::kShownFraction);

/// Display of a volume, besides its slices. Everything but the default needs the values of the volume.
struct VolumeDisplay {
  VolumeMode mode = VolumeMode::vectors;
  float share = kUsualShare;          // share of the voxels that are drawn as vectors
  bool surface = false;               // draw the isosurface
  std::optional<float> isovalue;      // nullopt means VolumeHistogram::threshold()
  std::optional<std::uint32_t> step;  // of a time series; nullopt means that of the stream
  glm::vec3 surface_color{0.87f, 0.79f, 0.68f};
  [[nodiscard]] bool needs_values() const {
    return mode != VolumeMode::vectors || share != kUsualShare || surface || step;
  }
  friend bool operator==(const VolumeDisplay&, const VolumeDisplay&) = default;
};

/// Parses a share of the voxels, such as "0.2" or "20%". Returns nullopt outside of the limits.
[[nodiscard]] std::optional<float> read_share(std::string_view text);

}  // namespace gs::app
