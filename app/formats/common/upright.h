#pragma once

#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::app {

/// How what a file holds stands: what is up, and where he stands who sees it from the front. World space; of length 1
/// and at right angles.
struct Upright {
  glm::vec3 up{0, 1, 0}, front{0, 0, 1};
  /// Parts of constructions have no face: they are first seen from the front, the right and above at once.
  bool three_quarter = false;

  [[nodiscard]] glm::vec3 right() const { return glm::cross(up, front); }
  bool operator==(const Upright&) const = default;
};
/// Its right, up and front as the axes x, y and z of VRML97 (4.4.5) have them.
[[nodiscard]] glm::dmat3 world_from_upright(const Upright& upright);

/// What the user says is up; automatic: the file, or its format, says so.
enum class UpAxis : std::uint8_t { automatic, x, minus_x, y, minus_y, z, minus_z };
struct UpAxisRow {
  UpAxis axis;
  std::string_view name;  // on the command line, in settings and in metadata of streams
};
[[nodiscard]] const std::array<UpAxisRow, 7>& up_axes();
[[nodiscard]] std::optional<UpAxis> find_up_axis(std::string_view name);
[[nodiscard]] std::string_view name_of(UpAxis axis);
/// With its usual front: +x is to the right where y or z is up.
[[nodiscard]] Upright upright_of(UpAxis axis);
/// Any front that goes with `up`, which is of length 1; the usual one of an axis.
[[nodiscard]] Upright upright_along(const glm::vec3& up);

/// What is up in files of a format, by a column of its table.
enum class UpRule : std::uint8_t {
  y,          // VRML97, glTF, and those that say nothing; splats, which are turned so when they are read
  z,          // of constructions, in a three-quarter view
  by_shape,   // +z, seen from +y, of what is by far the longest along z, else +y: PLY says nothing
  survey,     // +z of what is metres large, as land and buildings are, else +y: points
  slices,     // a stack of pictures: the first is on top, and its first row in front
  patient_s,  // superior is +z, anterior -y (DICOM, ITK: left, posterior, superior)
  patient_r,  // superior is +z, anterior +y (NIfTI: right, anterior, superior)
};
/// `size`: of the whole, along the axes.
[[nodiscard]] Upright upright_of(UpRule rule, const glm::vec3& size);

using StreamMetadata = std::span<const std::pair<std::string, std::string>>;
/// What a file says itself: keys `up` and `front` of a stream, each an axis, and `view`, `three-quarter` or nothing; or
/// NRRD's `space` of patients.
[[nodiscard]] std::optional<Upright> stated_upright(StreamMetadata metadata);
/// The keys `up`, `front` and `view` that say so; none where it stands as VRML97 has it, or along no axes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> metadata_of(const Upright& upright);

}  // namespace gs::app
