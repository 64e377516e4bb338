#include "app/formats/common/scene_builder.h"

#include "app/formats/common/geometry_check.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

using vrml::NodeId;
using vrml::NodeKind;

constexpr std::size_t kMaxNameBytes = 200;

/// Returns true if an Id may contain the character (VRML97 Annex A). Bytes over 0x7f are parts of UTF-8 letters and
/// allowed.
bool allowed_in_id(char c) {
  const auto byte = static_cast<unsigned char>(c);
  constexpr std::string_view kForbidden = "\"#',.[\\]{}";
  return byte > 0x20 && byte != 0x7f && kForbidden.find(c) == std::string_view::npos;
}

bool forbidden_at_start(char c) { return (c >= '0' && c <= '9') || c == '+' || c == '-'; }

/// Returns true if the Id is a keyword (VRML97 Annex A).
bool is_keyword(std::string_view id) {
  constexpr std::string_view kKeywords[] = {"DEF",     "EXTERNPROTO", "FALSE",        "IS",   "NULL",
                                            "PROTO",   "ROUTE",       "TO",           "TRUE", "USE",
                                            "eventIn", "eventOut",    "exposedField", "field"};
  return std::find(std::begin(kKeywords), std::end(kKeywords), id) != std::end(kKeywords);
}

}  // namespace

SceneBuilder::~SceneBuilder() {
  const std::uint64_t bytes = memory().amount();
  memory().shrink_to(0);
  if (bytes > 0) (void)scene_.memory().charge(static_cast<std::size_t>(bytes));
}

NodeId SceneBuilder::make(const vrml::NodeType& type) {
  const NodeId node = scene_.create(type);
  if (!node && !full_) {
    full_ = true;
    fail("too many nodes: the rest is left out");
  }
  return node;
}

void SceneBuilder::name(NodeId node, std::string_view text) {
  if (!node || text.empty()) return;
  text = text.substr(0, kMaxNameBytes);
  std::string id;
  if (forbidden_at_start(text.front())) id += '_';
  for (const char c : text) id += allowed_in_id(c) ? c : '_';
  if (is_keyword(id)) id += '_';
  // Start with the number of used names as the suffix, because `id` with this suffix is rarely in use.
  const std::string first = id + '_';
  for (std::size_t number = names_.size(); !names_.insert(id).second; ++number) id = first + std::to_string(number);
  scene_.node(node).name = *scene_.texts().keep_name(id);
}

NodeId SceneBuilder::appearance(const Look& look) {
  const NodeId appearance = make(NodeKind::appearance);
  if (look.lit) {
    const NodeId material = make(NodeKind::material);
    set(material, "diffuseColor", look.diffuse);
    set(material, "specularColor", look.specular);
    set(material, "emissiveColor", look.emissive);
    set(material, "ambientIntensity", look.ambient_intensity);
    set(material, "shininess", look.shininess);
    set(material, "transparency", look.transparency);
    set(appearance, "material", material);
  }
  if (!look.texture_url.empty()) {
    const NodeId texture = make(NodeKind::image_texture);
    set(texture, "url", vrml::MFString{look.texture_url});
    set(texture, "repeatS", look.repeat_s);
    set(texture, "repeatT", look.repeat_t);
    set(appearance, "texture", texture);
  }
  return appearance;
}

NodeId SceneBuilder::geometry(Geometry data) {
  return keep_drawable(data, *this) ? checked_geometry(std::move(data)) : NodeId{};
}

NodeId SceneBuilder::checked_geometry(Geometry data) {
  const bool has_index = data.kind != Geometry::Kind::points;
  const bool faces = data.kind == Geometry::Kind::faces;
  const NodeId node = make(faces       ? NodeKind::indexed_face_set
                           : has_index ? NodeKind::indexed_line_set
                                       : NodeKind::point_set);
  const auto attach = [&](std::string_view field, NodeKind kind, std::string_view inner, auto values) {
    if (values.empty()) return;
    const NodeId property = make(kind);
    set(property, inner, std::move(values));
    set(node, field, property);
  };
  const bool has_colors = !data.colors.empty();
  attach("coord", NodeKind::coordinate, "point", std::move(data.positions));
  attach("color", NodeKind::color, "color", std::move(data.colors));
  if (!has_index) return node;
  if (has_colors) set(node, "colorPerVertex", data.color_per_vertex);
  if (faces) {
    const bool has_normals = !data.normals.empty(), has_texture = !data.texture_coordinates.empty();
    attach("normal", NodeKind::normal, "vector", std::move(data.normals));
    attach("texCoord", NodeKind::texture_coordinate, "point", std::move(data.texture_coordinates));
    if (has_normals) set(node, "normalIndex", std::move(data.normal_index));
    if (has_texture) set(node, "texCoordIndex", std::move(data.texture_index));
    set(node, "solid", data.solid);
    set(node, "convex", data.convex);
    set(node, "creaseAngle", data.crease_angle);
  }
  set(node, "coordIndex", std::move(data.coord_index));
  return node;
}

NodeId SceneBuilder::shape(NodeId geometry, NodeId appearance) {
  if (!geometry) return {};
  const NodeId shape = make(NodeKind::shape);
  set(shape, "geometry", geometry);
  set(shape, "appearance", appearance);
  return shape;
}

float display_of_linear(float linear) {
  if (!(linear > 0)) return 0;
  if (linear >= 1) return 1;
  return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

}  // namespace gs::app
