#pragma once

#include "qnv/base/geometry.h"
#include "render/scene/world_bounds.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

/// Logic of the splat and volume panel, without the panel itself: pure functions.
namespace gs::app {

// The transfer function ------------------------------------------------------------------------------

/// Sorted by value; values and opacities are 0..1.
using Transfer = std::vector<qnv::TransferPoint>;

inline constexpr std::size_t kMaxTransferPoints = 64;

/// Sanitises a function: sorts it, clamps it to 0..1, and drops non-finite points and those over kMaxTransferPoints.
/// Never returns an empty function.
[[nodiscard]] Transfer sound_transfer(Transfer points);
/// Returns a volume's initial function: its own, or a default one.
[[nodiscard]] Transfer own_transfer(const qnv::Description& volume);
/// Returns colour and opacity at a value 0..1: linear between points, constant outside, like volume_model.
[[nodiscard]] qnv::TransferPoint transfer_at(const Transfer& transfer, float value);

/// Adds a point with the function's present colour. Returns its index; nullopt if there are kMaxTransferPoints
/// already.
std::optional<std::size_t> add_point(Transfer& transfer, float value, float opacity);
/// Moves a point, but not past its neighbours.
void move_point(Transfer& transfer, std::size_t index, float value, float opacity);
/// Removes a point unless it is the last one left. Returns whether it did.
bool remove_point(Transfer& transfer, std::size_t index);

/// Preset of a transfer function.
struct TransferPreset {
  const char* label;
  const char* help;
  Transfer (*make)(std::pair<float, float> value_range);
};
/// Returns all presets, without the volume's own function. CT presets detect Hounsfield units, or values 1000 above
/// them, by the range. For other ranges they use about the same fractions.
[[nodiscard]] std::span<const TransferPreset> transfer_presets();

// Content of the volumes ----------------------------------------------------------------------------

/// Statistics of a volume's vectors. Compute once per volume: the time is proportional to the number of vectors.
struct VolumeSummary {
  std::array<float, 256> classes{};  // sum of magnitudes by class, scaled to a maximum of 1
  std::vector<float> magnitudes;     // > 0, sorted; a sample of up to 65,536 vectors
  [[nodiscard]] float least() const { return magnitudes.empty() ? 0.0f : magnitudes.front(); }
  [[nodiscard]] float largest() const { return magnitudes.empty() ? 0.0f : magnitudes.back(); }
};
[[nodiscard]] VolumeSummary summarize(std::span<const std::shared_ptr<const qnv::Volume>> volumes);
/// Returns the fraction, 0..1, of vectors with at least this magnitude.
[[nodiscard]] float share_left(const VolumeSummary& summary, float least_magnitude);

// Sliders ---------------------------------------------------------------------------------------------

/// Logarithmic slider scale from 0 to 1, where 0 < least < largest.
struct LogScale {
  float least = 0.1f, largest = 10;
  bool zero = false;  // the lower end means 0
  [[nodiscard]] float value_at(float place) const;
  [[nodiscard]] float place_of(float value) const;
};
/// Returns the scale of SplatStyle::opacity; the default is in the middle.
[[nodiscard]] LogScale opacity_scale();
/// Returns the scale of SplatStyle::least_magnitude.
[[nodiscard]] LogScale magnitude_scale(const VolumeSummary& summary);

// The clipping plane ------------------------------------------------------------------------------------

enum class ClipAxis : std::uint8_t { x, y, z, view };

struct ClipChoice {
  ClipAxis axis = ClipAxis::x;
  bool flip = false;         // for x, y, z: keeps the lower part
  glm::vec3 view{0, 0, -1};  // for `view`: unit vector towards the kept side
  float place = 0.5f;        // 0 keeps everything, 1 nothing
};

/// Returns the world-space plane for SplatStyle::clip, which keeps points with xyz . position + w >= 0.
[[nodiscard]] glm::dvec4 clip_plane(const ClipChoice& choice, const WideBox& bounds);
/// Returns the choice that gives this plane.
[[nodiscard]] ClipChoice clip_choice(const glm::dvec4& plane, const WideBox& bounds);
/// Keeps the other side; the plane does not move.
[[nodiscard]] ClipChoice flipped(ClipChoice choice);

}  // namespace gs::app
