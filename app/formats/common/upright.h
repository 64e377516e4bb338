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

/// Orientation of a file's content: its up and front directions as orthogonal unit vectors in world space. The front
/// faces the viewer.
struct Upright {
  glm::vec3 up{0, 1, 0}, front{0, 0, 1};
  /// true for an initial view from the front, right and above, for CAD parts, which have no front
  bool three_quarter = false;

  [[nodiscard]] glm::vec3 right() const { return glm::cross(up, front); }
  bool operator==(const Upright&) const = default;
};
/// Returns the matrix with the columns right, up and front. In VRML97 these directions are x, y and z (4.4.5).
[[nodiscard]] glm::dmat3 world_from_upright(const Upright& upright);

/// User's choice of the up axis. `automatic` uses the file or its format.
enum class UpAxis : std::uint8_t { automatic, x, minus_x, y, minus_y, z, minus_z };
struct UpAxisRow {
  UpAxis axis;
  std::string_view name;  // name on the command line, in settings and in stream metadata
};
[[nodiscard]] const std::array<UpAxisRow, 7>& up_axes();
[[nodiscard]] std::optional<UpAxis> find_up_axis(std::string_view name);
[[nodiscard]] std::string_view name_of(UpAxis axis);
/// Returns the orientation with `axis` up, and with the usual front for it. If y or z is up, +x is to the right.
[[nodiscard]] Upright upright_of(UpAxis axis);
/// Returns an orientation with the unit vector `up`. If `up` is an axis, the front is the usual one for it.
[[nodiscard]] Upright upright_along(const glm::vec3& up);

/// Rule that gives the up direction of a file format. A column of the format table.
enum class UpRule : std::uint8_t {
  y,  // VRML97, glTF, formats without a rule; also splats, which importers rotate
  z,  // CAD files; the initial view is a three-quarter view
  by_shape,  // PLY, which defines no axis: +z, seen from +y, if z is by far the longest; else +y
  survey,  // points: +z for content of over 5 m, such as land or buildings; else +y
  slices,  // image stack: first slice on top, first row of a slice in front
  patient_s,  // medical: +z is superior, -y anterior (DICOM, ITK: left, posterior, superior)
  patient_r,  // medical: +z is superior, +y anterior (NIfTI: right, anterior, superior)
};
/// Returns the orientation that a rule gives. `size` is the extent of the whole content along x, y and z.
[[nodiscard]] Upright upright_of(UpRule rule, const glm::vec3& size);
/// Returns true for the rules of stacks of slices.
[[nodiscard]] bool has_slices(UpRule rule);
/// Returns the orientation in which a stack of slices is seen face on if it has a single slice; else `upright`.
[[nodiscard]] Upright facing_flat(const Upright& upright, const glm::vec3& size);

using StreamMetadata = std::span<const std::pair<std::string, std::string>>;
/// Returns the orientation in the metadata of a stream, or nullopt. The keys `up` and `front` are axes; the key `view`
/// is `three-quarter` or absent. The key `space` is from NRRD and names patient directions.
[[nodiscard]] std::optional<Upright> stated_upright(StreamMetadata metadata);
/// Returns the metadata keys `up`, `front` and `view` for an orientation. Returns none for the default of VRML97.
/// Returns none if the directions are not axes.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> metadata_of(const Upright& upright);

}  // namespace gs::app
