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

/// Orientation of a file's content: up and front directions in world space, orthogonal unit vectors. The front faces
/// the viewer.
struct Upright {
  glm::vec3 up{0, 1, 0}, front{0, 0, 1};
  /// Initial view from the front, right and above; for CAD parts, which have no front.
  bool three_quarter = false;

  [[nodiscard]] glm::vec3 right() const { return glm::cross(up, front); }
  bool operator==(const Upright&) const = default;
};
/// Returns a matrix with right, up and front as its columns: the axes x, y and z of VRML97 (4.4.5).
[[nodiscard]] glm::dmat3 world_from_upright(const Upright& upright);

/// User's choice of the up axis; automatic uses the file or its format.
enum class UpAxis : std::uint8_t { automatic, x, minus_x, y, minus_y, z, minus_z };
struct UpAxisRow {
  UpAxis axis;
  std::string_view name;  // name on the command line, in settings and in stream metadata
};
[[nodiscard]] const std::array<UpAxisRow, 7>& up_axes();
[[nodiscard]] std::optional<UpAxis> find_up_axis(std::string_view name);
[[nodiscard]] std::string_view name_of(UpAxis axis);
/// Returns the orientation for an axis with its usual front: +x is to the right if y or z is up.
[[nodiscard]] Upright upright_of(UpAxis axis);
/// Returns an orientation for the unit vector `up`, with the usual front if it is an axis.
[[nodiscard]] Upright upright_along(const glm::vec3& up);

/// Rule that derives the up direction from a file format; a column of the format table.
enum class UpRule : std::uint8_t {
  y,          // VRML97, glTF, formats without a convention; splat files, which the importer rotates
  z,          // CAD files, with a three-quarter view
  by_shape,   // +z, seen from +y, for shapes much longer along z; else +y. PLY defines no axis
  survey,     // +z for content metres in size, such as land and buildings; else +y. For points
  slices,     // image stack: the first slice is on top, its first row in front
  patient_s,  // superior is +z, anterior -y (DICOM, ITK: left, posterior, superior)
  patient_r,  // superior is +z, anterior +y (NIfTI: right, anterior, superior)
};
/// Applies a rule. `size` is the extent of the whole content along the axes.
[[nodiscard]] Upright upright_of(UpRule rule, const glm::vec3& size);

using StreamMetadata = std::span<const std::pair<std::string, std::string>>;
/// Returns the orientation that a file states: stream keys `up` and `front` (axes) and `view` (`three-quarter` or
/// absent), or the patient `space` of NRRD.
[[nodiscard]] std::optional<Upright> stated_upright(StreamMetadata metadata);
/// Returns the keys `up`, `front` and `view` for an orientation. Returns none for the default of VRML97, or if it is
/// not along axes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> metadata_of(const Upright& upright);

}  // namespace gs::app
