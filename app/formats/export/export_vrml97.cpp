#include "app/formats/common/color_key.h"
#include "app/formats/common/upright.h"
#include "app/formats/export/export.h"
#include "app/formats/export/export_vectors.h"
#include "app/formats/export/vrml_text.h"

#include <glm/gtc/quaternion.hpp>

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace gs::app {

std::string front_viewpoint(const Box& box, const Upright& upright) {
  const glm::vec3 size = box.size(), middle = box.lower + size * 0.5f;
  const float radius = std::sqrt(size.x * size.x + size.y * size.y + size.z * size.z) / 2;
  constexpr float kDistance = 2.6f;  // in radii of the scene: 1 / sin(fieldOfView / 2), default field of view
  std::string text;
  const auto numbers = [&](const glm::vec3& v) {
    for (int k = 0; k < 3; ++k) {
      append_number(text, v[k]);
      text += ' ';
    }
  };
  if (upright == Upright{}) {
    text += "Viewpoint { description \"Front\" position ";
    numbers({middle.x, middle.y, middle.z + kDistance * radius});
    return text += "}\n";
  }
  // The up direction of a Viewpoint is the y axis of its coordinate system (VRML97 6.29).
  const glm::dquat turn = glm::quat_cast(world_from_upright(upright));
  text += "Transform { translation ";
  numbers(middle);
  text += "rotation ";
  numbers(glm::vec3(glm::axis(turn)));
  append_number(text, static_cast<float>(glm::angle(turn)));
  text += " children Viewpoint { description \"Front\" position ";
  numbers({0, 0, kDistance * radius});
  return text += "} }\n";
}

namespace {

/// Interface of the built-in QNV node. Browsers without this node use the PROTO with this interface.
constexpr std::string_view kInterface =
    "PROTO QNV [\n"
    "  exposedField MFString url []\n"
    "  exposedField SFFloat detail 1\n"
    "  exposedField SFString profile \"SURFACE\"\n"
    "  exposedField MFFloat transfer []\n"
    "  field MFInt32 vectors []\n"
    "  field SFVec3f bboxCenter 0 0 0\n"
    "  field SFVec3f bboxSize -1 -1 -1\n"
    "  eventOut SFFloat progress_changed\n"
    "  eventOut SFTime loadTime\n"
    "] {\n";

// Direction to the light that is baked into the colours of points: above and behind the viewer.
constexpr glm::vec3 kLight{0.27f, 0.53f, 0.80f};
constexpr float kAmbient = 0.3f;

class Vrml97Text {
 public:
  void add(std::string_view text) { out_ += text; }
  void number(float value) { append_number(out_, value); }
  void vector(const glm::vec3& v, char end = '\n') {
    for (int k = 0; k < 3; ++k) {
      number(v[k]);
      out_ += k < 2 ? ' ' : end;
    }
  }
  /// Writes a colour with three decimals, which distinguish all 256 levels.
  void color(const glm::vec3& rgb) {
    vector({std::round(rgb.x * 1000) / 1000, std::round(rgb.y * 1000) / 1000, std::round(rgb.z * 1000) / 1000});
  }
  void quoted(std::string_view text) { append_quoted(out_, text); }
  [[nodiscard]] std::vector<std::byte> bytes() const {
    const auto* first = reinterpret_cast<const std::byte*>(out_.data());
    return {first, first + out_.size()};
  }

 private:
  std::string out_;
};

glm::vec3 rgb_of(const qnv::Rgb8& color) {
  return {static_cast<float>(color.r) / 255, static_cast<float>(color.g) / 255, static_cast<float>(color.b) / 255};
}

void put_points(const std::vector<ExportVector>& exported, bool shaded, Vrml97Text& text) {
  text.add("  PointSet {\n    coord Coordinate { point [\n");
  for (const ExportVector& item : exported) text.vector(item.position);
  text.add("    ] }\n    color Color { color [\n");
  for (const ExportVector& item : exported) {
    const glm::vec3& n = item.normal;
    const float facing = std::min(std::abs(n.x * kLight.x + n.y * kLight.y + n.z * kLight.z), 1.0f);
    text.color(rgb_of(item.color) * (shaded ? kAmbient + (1 - kAmbient) * facing : 1.0f));
  }
  text.add("    ] }\n  }\n");
}

/// Returns the corners of a square with the area of the vector, counterclockwise when seen against the normal.
std::array<glm::vec3, 4> corners_of(const ExportVector& item) {
  const glm::vec3& n = item.normal;
  // Start with the axis that is least aligned to the normal.
  const bool along_x = std::abs(n.x) < 0.6f;
  glm::vec3 u = along_x ? glm::vec3(0, n.z, -n.y) : glm::vec3(-n.z, 0, n.x);
  const float length = std::sqrt(u.x * u.x + u.y * u.y + u.z * u.z);
  u = length > 0 ? u / length : glm::vec3(1, 0, 0);
  const glm::vec3 v(n.y * u.z - n.z * u.y, n.z * u.x - n.x * u.z, n.x * u.y - n.y * u.x);
  const float half = std::sqrt(item.area) / 2;
  const glm::vec3 a = (u + v) * half, b = (v - u) * half;
  return {item.position - a, item.position - b, item.position + a, item.position + b};
}

void put_patches(const std::vector<ExportVector>& exported, Vrml97Text& text) {
  text.add("  IndexedFaceSet {\n    solid FALSE\n    normalPerVertex FALSE\n    colorPerVertex FALSE\n");
  text.add("    coord Coordinate { point [\n");
  for (const ExportVector& item : exported) {
    const auto corners = corners_of(item);
    for (std::size_t k = 0; k < 4; ++k) text.vector(corners[k], k < 3 ? ',' : '\n');
  }
  text.add("    ] }\n    coordIndex [\n");
  for (std::size_t i = 0; i < exported.size(); ++i) {
    for (std::size_t k = 0; k < 4; ++k) text.add(std::to_string(4 * i + k) + " ");
    text.add("-1\n");
  }
  text.add("    ]\n    normal Normal { vector [\n");
  for (const ExportVector& item : exported) text.vector(item.normal);
  text.add("    ] }\n    color Color { color [\n");
  for (const ExportVector& item : exported) text.color(rgb_of(item.color));
  text.add("    ] }\n  }\n");
}

void put_viewpoint(const qnv::Description& description, Vrml97Text& text) {
  text.add("NavigationInfo { type [ \"EXAMINE\", \"ANY\" ] }\n");
  text.add(front_viewpoint(description.box, stated_upright(description.metadata).value_or(Upright{})));
  if (const auto key = color_key_of(description.metadata)) {
    text.add("WorldInfo { info ");
    text.quoted(color_key_text(*key));
    text.add(" }\n");
  }
}

/// Writes the QNV instance. If `moved`, a Transform holds the origin and all coordinates are relative to it, so that
/// float32 is exact.
void put_instance(const qnv::VectorView& vectors, const ExportOptions& options, bool moved, Vrml97Text& text) {
  text.add("}\n");
  if (moved) {
    text.add("Transform {\n translation ");
    text.vector(glm::vec3(vectors.description.origin));
    text.add(" children [\n");
  }
  if (!vectors.description.box.empty()) put_viewpoint(vectors.description, text);
  // Default colour of vectors without a colour.
  text.add("Shape {\n  appearance Appearance { material Material { ");
  if (vectors.kind == qnv::Kind::surface && vectors.colors.empty()) {
    text.add("diffuseColor ");
    text.color(rgb_of(vectors.color));
  }
  text.add("} }\n  geometry QNV {\n");
  if (!options.stream_url.empty()) {
    text.add("    url ");
    text.quoted(options.stream_url);
    text.add("\n");
  }
  if (vectors.kind == qnv::Kind::volume) text.add("    profile \"VOLUME\"\n");
  if (const Box& box = vectors.description.box; !box.empty()) {
    text.add("    bboxCenter ");
    text.vector(box.lower + box.size() * 0.5f);
    text.add("    bboxSize ");
    text.vector(box.size());
  }
  text.add("  }\n}\n");
  if (moved) text.add(" ]\n}\n");
}

/// Returns the geometry with world coordinates in float32 and origin 0.
qnv::Geometry about_zero(qnv::Geometry geometry) {
  qnv::Description& description = geometry.base().description;
  const glm::dvec3 origin = std::exchange(description.origin, glm::dvec3(0));
  const auto move = [&](glm::vec3& p) { p = glm::vec3(origin + glm::dvec3(p)); };
  if (qnv::VectorArrays* arrays = geometry.arrays())
    for (glm::vec3& p : arrays->positions) move(p);
  move(description.box.lower);
  move(description.box.upper);
  return geometry;
}

std::vector<std::byte> world_of(const qnv::Geometry& given, const ExportOptions& options, bool patches) {
  // With a stream URL, browsers with the QNV node take the origin from the stream.
  const bool far = given.description().origin != glm::dvec3(0), moved = far && options.stream_url.empty();
  std::optional<qnv::Geometry> near;
  if (far && !moved) near = about_zero(given);
  const qnv::VectorView vectors(near ? *near : given);
  const ExportVectors all(vectors);
  const std::vector<ExportVector> exported = visible_vectors(all);
  Vrml97Text text;
  text.add("#VRML V2.0 utf8 written by GhostSpace\n");
  if (!options.title.empty()) {
    text.add("WorldInfo { title ");
    text.quoted(options.title);
    text.add(" }\n");
  }
  text.add(kInterface);
  if (patches)
    put_patches(exported, text);
  else
    put_points(exported, vectors.colors.empty() && !all.balls(), text);
  put_instance(vectors, options, moved, text);
  return text.bytes();
}

}  // namespace

Exported export_vrml97_points(const qnv::Geometry& geometry, const ExportOptions& options) {
  return world_of(geometry, options, false);
}

Exported export_vrml97_patches(const qnv::Geometry& geometry, const ExportOptions& options) {
  if (geometry.size() > std::size_t{1} << 29) return "too many vectors for the indices of VRML97";
  return world_of(geometry, options, true);
}

}  // namespace gs::app
