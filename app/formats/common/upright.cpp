#include "app/formats/common/upright.h"

#include "base/text.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace gs::app {
namespace {

constexpr std::string_view kThreeQuarter = "three-quarter";
constexpr std::array<UpAxisRow, 7> kUpAxes{{{UpAxis::automatic, "auto"},
                                            {UpAxis::x, "x"},
                                            {UpAxis::minus_x, "-x"},
                                            {UpAxis::y, "y"},
                                            {UpAxis::minus_y, "-y"},
                                            {UpAxis::z, "z"},
                                            {UpAxis::minus_z, "-z"}}};

glm::vec3 axis_vector(UpAxis axis) {
  if (axis == UpAxis::automatic) return {0, 1, 0};
  const int number = static_cast<int>(axis) - 1;
  glm::vec3 vector(0);
  vector[number / 2] = number % 2 == 0 ? 1.0f : -1.0f;
  return vector;
}

std::optional<glm::vec3> vector_of(std::string_view name) {
  const auto axis = find_up_axis(name);
  return axis && *axis != UpAxis::automatic ? std::optional(axis_vector(*axis)) : std::nullopt;
}

std::optional<std::string_view> name_of(const glm::vec3& vector) {
  for (const UpAxisRow& row : kUpAxes)
    if (row.axis != UpAxis::automatic && axis_vector(row.axis) == vector) return row.name;
  return std::nullopt;
}

/// Parses the field `space` of NRRD: "left-posterior-superior" or "LPS", optionally with "-time". Each word is the
/// direction of one axis.
std::optional<Upright> upright_of_space(std::string_view text) {
  std::string space = lower_case(text);
  if (space.size() <= 4 && space.find('-') == std::string::npos) {  // "lps", "last"
    std::string words;
    for (const char letter : space) words += std::string(1, letter) + '-';
    space = words;
  }
  std::optional<glm::vec3> up, front;
  std::size_t at = 0;
  for (int axis = 0; axis < 3 && at < space.size(); ++axis) {
    const std::size_t end = std::min(space.find('-', at), space.size());
    const std::string_view word = std::string_view(space).substr(at, end - at);
    at = end + 1;
    glm::vec3 along(0);
    along[axis] = 1;
    if (word == "superior" || word == "s") up = along;
    if (word == "inferior" || word == "i") up = -along;
    if (word == "anterior" || word == "a") front = along;
    if (word == "posterior" || word == "p") front = -along;
  }
  return up && front ? std::optional(Upright{*up, *front}) : std::nullopt;
}

}  // namespace

glm::dmat3 world_from_upright(const Upright& upright) {
  return {glm::dvec3(upright.right()), glm::dvec3(upright.up), glm::dvec3(upright.front)};
}

const std::array<UpAxisRow, 7>& up_axes() { return kUpAxes; }

std::optional<UpAxis> find_up_axis(std::string_view name) {
  if (name.starts_with('+') && !name.starts_with("+-")) name.remove_prefix(1);
  for (const UpAxisRow& row : kUpAxes)
    if (row.name == name) return row.axis;
  return std::nullopt;
}

std::string_view name_of(UpAxis axis) { return kUpAxes[static_cast<std::size_t>(axis)].name; }

Upright upright_of(UpAxis axis) { return upright_along(axis_vector(axis)); }

Upright upright_along(const glm::vec3& up) {
  // If +x is up, the viewer looks from +z, as for +y.
  const glm::vec3 right = std::abs(up.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, up.x > 0 ? -1 : 1, 0);
  return {up, glm::normalize(glm::cross(right, up))};
}

Upright upright_of(UpRule rule, const glm::vec3& size) {
  constexpr float kStanding = 1.5f;  // min ratio of height to width and depth
  constexpr float kSurvey = 5;  // metres; larger geometries are land or buildings
  switch (rule) {
    case UpRule::y:
      break;
    case UpRule::z: {
      Upright upright = upright_of(UpAxis::z);
      upright.three_quarter = true;
      return upright;
    }
    case UpRule::by_shape:
      if (size.z > kStanding * std::max(size.x, size.y)) return {{0, 0, 1}, {0, 1, 0}};
      break;
    case UpRule::survey:
      return upright_of(std::max({size.x, size.y, size.z}) > kSurvey ? UpAxis::z : UpAxis::y);
    case UpRule::slices:
      return facing_flat({{0, 0, -1}, {0, -1, 0}}, size);
    case UpRule::patient_s:
      return facing_flat({{0, 0, 1}, {0, -1, 0}}, size);
    case UpRule::patient_r:
      return facing_flat({{0, 0, 1}, {0, 1, 0}}, size);
  }
  return {};
}

bool has_slices(UpRule rule) {
  return rule == UpRule::slices || rule == UpRule::patient_s || rule == UpRule::patient_r;
}

Upright facing_flat(const Upright& upright, const glm::vec3& size) {
  constexpr float kFlat = 1e-3f;  // max ratio of the depth of a picture to its width and height
  const auto is_flat = [&](int axis) {
    const float depth = size[axis], width = size[(axis + 1) % 3], height = size[(axis + 2) % 3];
    return std::min(width, height) > 0 && depth >= 0 && depth <= kFlat * std::min(width, height);
  };
  // The first row of a single slice is on top, its first column on the left.
  if (is_flat(2)) return {{0, -1, 0}, {0, 0, -1}};
  if (is_flat(0)) return {upright.up, {1, 0, 0}};
  return upright;
}

std::optional<Upright> stated_upright(StreamMetadata metadata) {
  std::optional<glm::vec3> up, front;
  std::optional<Upright> of_space;
  bool three_quarter = false;
  for (const auto& [key, value] : metadata) {
    if (key == "up") up = vector_of(value);
    if (key == "front") front = vector_of(value);
    if (key == "view") three_quarter = value == kThreeQuarter;
    if (key == "space") of_space = upright_of_space(value);
  }
  if (!up) return of_space;
  Upright upright = upright_along(*up);
  if (front && glm::dot(*up, *front) == 0) upright.front = *front;
  upright.three_quarter = three_quarter;
  return upright;
}

std::vector<std::pair<std::string, std::string>> metadata_of(const Upright& upright) {
  const auto up = name_of(upright.up), front = name_of(upright.front);
  std::vector<std::pair<std::string, std::string>> metadata;
  if (upright == Upright{} || !up || !front) return metadata;
  metadata.emplace_back("up", *up);
  if (upright.front != upright_along(upright.up).front) metadata.emplace_back("front", *front);
  if (upright.three_quarter) metadata.emplace_back("view", kThreeQuarter);
  return metadata;
}

}  // namespace gs::app
