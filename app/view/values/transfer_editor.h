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

/// Logic of the panel for splats and volumes, as pure functions. The panel itself only draws.
namespace gs::app {

// Transfer function ----------------------------------------------------------------------------------

/// Transfer function: points sorted by value. Values and opacities are 0..1.
using Transfer = std::vector<qnv::TransferPoint>;

inline constexpr std::size_t kMaxTransferPoints = 64;

/// Makes a transfer function valid. Sorts it and clamps it to 0..1. Drops non-finite points, and those in excess of
/// kMaxTransferPoints. The result is never empty.
[[nodiscard]] Transfer sound_transfer(Transfer points);
/// Returns the transfer function of a volume: that of its file, or a default one.
[[nodiscard]] Transfer own_transfer(const qnv::Description& volume);
/// Returns colour and opacity of a transfer function at a value in 0..1. Interpolates linearly between the points, and
/// is constant outside of them, as volume_model() is.
[[nodiscard]] qnv::TransferPoint transfer_at(const Transfer& transfer, float value);

/// Adds a point with the colour that the function has at this value. Returns the index of the point; nullopt if there
/// are already kMaxTransferPoints points.
std::optional<std::size_t> add_point(Transfer& transfer, float value, float opacity);
/// Moves a point to a value and an opacity, but not past its neighbours.
void move_point(Transfer& transfer, std::size_t index, float value, float opacity);
/// Removes a point. Returns false, without effect, if it is the only one.
bool remove_point(Transfer& transfer, std::size_t index);

/// Stretches a transfer function, so that its first and last point are at these values in 0..1. Returns false, without
/// effect, if all points have the same value.
bool stretch(Transfer& transfer, float first, float last);

/// Preset of a transfer function.
struct TransferPreset {
  const char* label;
  const char* help;
  Transfer (*make)(std::pair<float, float> value_range);
};
/// Returns all presets; the function of the volume itself is none of them. A CT preset detects by the range whether the
/// values are Hounsfield units or 1000 above them. For other ranges, it uses about the same fractions of the range.
[[nodiscard]] std::span<const TransferPreset> transfer_presets();

// Content of volumes ---------------------------------------------------------------------------------

/// Statistics of the vectors of volumes. Compute them once, because the time is proportional to the number of vectors.
struct VolumeSummary {
  std::array<float, 256> classes{};  // by class: sum of the magnitudes, divided by the largest sum
  std::vector<float> magnitudes;     // sorted magnitudes > 0; a sample of at most 65,536 vectors
  [[nodiscard]] float least() const { return magnitudes.empty() ? 0.0f : magnitudes.front(); }
  [[nodiscard]] float largest() const { return magnitudes.empty() ? 0.0f : magnitudes.back(); }
};
[[nodiscard]] VolumeSummary summarize(std::span<const std::shared_ptr<const qnv::Volume>> volumes);
/// Returns the fraction, 0..1, of the vectors with a magnitude of at least `least_magnitude`.
[[nodiscard]] float share_left(const VolumeSummary& summary, float least_magnitude);

// Sliders ---------------------------------------------------------------------------------------------

/// Logarithmic scale of a slider: position 0 is `least`, position 1 is `largest`. 0 < least < largest.
struct LogScale {
  float least = 0.1f, largest = 10;
  bool zero = false;  // position 0 means the value 0 instead
  [[nodiscard]] float value_at(float place) const;
  [[nodiscard]] float place_of(float value) const;
};
/// Returns the scale for SplatStyle::opacity; the default opacity is in the middle.
[[nodiscard]] LogScale opacity_scale();
/// Returns the scale for SplatStyle::least_magnitude.
[[nodiscard]] LogScale magnitude_scale(const VolumeSummary& summary);

// Clipping plane ----------------------------------------------------------------------------------------

enum class ClipAxis : std::uint8_t { x, y, z, view };

struct ClipChoice {
  ClipAxis axis = ClipAxis::x;
  bool flip = false;         // keep the side with lower coordinates; for x, y, z
  glm::vec3 view{0, 0, -1};  // unit vector towards the side that is kept; for `view`
  float place = 0.5f;        // position of the plane; 0 keeps everything, 1 nothing
};

/// Returns the plane for SplatStyle::clip, in world space. It keeps points with xyz . position + w >= 0.
[[nodiscard]] glm::dvec4 clip_plane(const ClipChoice& choice, const WideBox& bounds);
/// Returns the choice that gives this plane; the inverse of clip_plane().
[[nodiscard]] ClipChoice clip_choice(const glm::dvec4& plane, const WideBox& bounds);
/// Returns the choice that keeps the other side of the same plane.
[[nodiscard]] ClipChoice flipped(ClipChoice choice);

}  // namespace gs::app
