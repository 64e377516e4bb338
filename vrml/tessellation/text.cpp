#include "base/budget.h"
#include "vrml/mesh/text_shaper.h"
#include "vrml/tessellation/tessellators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace gs::vrml {
namespace {

enum class Alignment : std::uint8_t { first, begin, middle, end };

/// Values of the FontStyle of a Text (VRML97 6.20). They are the defaults if it has none.
struct FontStyle {
  FontRequest font;
  bool horizontal = true, left_to_right = true, top_to_bottom = true;
  Alignment major = Alignment::begin, minor = Alignment::first;
  double size = 1, spacing = 1;
  bool in_points = false;  // ScreenFontStyle: the size is in points of the screen (X3D 36.4.5)
};

Alignment alignment(const MFString& justify, std::size_t place, Alignment otherwise) {
  if (place >= justify.size()) return otherwise;
  const std::string_view name = justify[place].view();
  if (name == "FIRST") return Alignment::first;
  if (name == "BEGIN") return Alignment::begin;
  if (name == "MIDDLE") return Alignment::middle;
  if (name == "END") return Alignment::end;
  return otherwise;
}

// Maximum number of font families that are tried, and maximum bytes of a name. Without limits, USE could multiply long
// names.
constexpr std::size_t kMaxFamilies = 16, kMaxName = 256;

FontStyle font_style_of(const SceneGraph& scene, NodeId geometry) {
  FontStyle style;
  const NodeId node = scene.resolve_as(scene.get<SFNode>(geometry, "fontStyle"), NodeKind::font_style);
  if (!node) return style;
  const MFString& families = scene.get<MFString>(node, "family");
  for (std::size_t i = 0; i < std::min(families.size(), kMaxFamilies); ++i)
    style.font.families.emplace_back(families[i].view().substr(0, kMaxName));
  const std::string_view name = scene.get<SFString>(node, "style").view();
  style.font.bold = name == "BOLD" || name == "BOLDITALIC";
  style.font.italic = name == "ITALIC" || name == "BOLDITALIC";
  style.font.language = scene.get<SFString>(node, "language").view().substr(0, kMaxName);
  style.horizontal = scene.get<SFBool>(node, "horizontal");
  style.left_to_right = scene.get<SFBool>(node, "leftToRight");
  style.top_to_bottom = scene.get<SFBool>(node, "topToBottom");
  const MFString& justify = scene.get<MFString>(node, "justify");
  style.major = alignment(justify, 0, Alignment::begin);
  style.minor = alignment(justify, 1, Alignment::first);
  style.in_points = scene.node(node).type->find_field("pointSize") != nullptr;
  const float size = scene.get<SFFloat>(node, style.in_points ? "pointSize" : "size"),
              spacing = scene.get<SFFloat>(node, "spacing");
  if (size > 0 && std::isfinite(size)) style.size = size;
  if (std::isfinite(spacing)) style.spacing = std::max(spacing, 0.0f);
  return style;
}

/// Returns the position along the major axis at which a line with the extent `extent` starts (Tables 6.2, 6.3).
double major_start(Alignment major, double extent) {
  return major == Alignment::middle ? -extent / 2 : major == Alignment::end ? -extent : 0.0;
}

/// Returns the position of the first base line along the minor axis, the direction in which lines follow each other.
/// `before` and `behind` are the extents of a line against and in that direction. `block` is the distance between the
/// first and the last base line (Tables 6.4, 6.5).
double minor_start(Alignment minor, bool horizontal, double before, double behind, double block) {
  switch (minor) {
    case Alignment::first:
      return horizontal ? 0.0 : before;
    case Alignment::begin:
      return before;
    case Alignment::middle:
      return (before - behind - block) / 2;
    case Alignment::end:
      return -block - behind;
  }
  return 0.0;
}

struct Line {
  ShapedText shaped;
  double extent = 0, stretch = 1;  // drawn extent in node space; ratio of drawn to natural extent
};

/// Applies the fields `length` and `maxExtent` (6.47.1). Both are in node space.
void fit_lines(std::vector<Line>& lines, const MFFloat& lengths, double max_extent, double size) {
  double longest = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    Line& line = lines[i];
    const double natural = line.shaped.extent * size;
    const double asked = i < lengths.size() && std::isfinite(lengths[i]) ? lengths[i] : 0.0;
    if (asked > 0 && natural > 0) line.stretch = asked / natural;
    line.extent = natural * line.stretch;
    longest = std::max(longest, line.extent);
  }
  if (!(max_extent > 0) || longest <= max_extent) return;
  for (Line& line : lines) {
    line.stretch *= max_extent / longest;
    line.extent *= max_extent / longest;
  }
}

constexpr std::uint64_t kBytesOfCharacter = 96;  // memory of a character while it is shaped, including its placed glyph
constexpr std::uint64_t kBytesOfPoint = 2 * sizeof(glm::vec3) + sizeof(glm::vec2), kBytesOfIndex = 4;

}  // namespace

// Counts about fifty triangles per character for its glyph outline.
std::size_t cost_of_text(const SceneGraph& scene, NodeId geometry) {
  constexpr std::size_t kOfCharacter = 300;
  std::size_t characters = 0;
  for (const SFString& line : scene.get<MFString>(geometry, "string")) characters += line.view().size();
  return characters * kOfCharacter;
}

Mesh tessellate_text(const SceneGraph& scene, NodeId geometry, const MeshOptions& options) {
  Mesh mesh;
  mesh.solid = false;  // "two-sided"
  const MFString strings = scene.get<MFString>(geometry, "string");
  if (!options.text_shaper || strings.empty()) return mesh;
  TextShaper& shaper = *options.text_shaper;
  const FontStyle style = font_style_of(scene, geometry);
  const TextDirection direction = style.horizontal ? (style.left_to_right ? TextDirection::right : TextDirection::left)
                                                   : (style.top_to_bottom ? TextDirection::down : TextDirection::up);

  const std::shared_ptr<Budget>& budget = scene.budget();
  Share share(budget, Resource::meshes);
  std::size_t points = 0, corners = 0;
  std::vector<Line> lines;
  if (!share.grow(strings.size() * sizeof(Line))) {
    mesh.limited = true;
    return mesh;
  }
  lines.resize(strings.size());
  for (std::size_t i = 0; i < strings.size() && !mesh.limited; ++i) {
    const std::string_view text = strings[i].view();
    if (text.empty()) continue;  // an empty line is not drawn but takes its space
    if (budget->stopped() || !share.grow(text.size() * kBytesOfCharacter)) {
      mesh.limited = true;
      break;
    }
    ShapedText& shaped = lines[i].shaped = shaper.shape(style.font, text, direction, options.text_level);
    std::size_t more_points = 0, more_corners = 0;
    for (const PlacedGlyph& glyph : shaped.glyphs) {
      if (!glyph.shape) continue;
      mesh.pictured = mesh.pictured || !glyph.shape->coordinates.empty();
      more_points += glyph.shape->points.size();
      more_corners += glyph.shape->triangles.size();
    }
    if (points + more_points >= std::numeric_limits<std::uint32_t>::max() ||
        !share.grow(more_points * kBytesOfPoint + more_corners * kBytesOfIndex)) {
      mesh.limited = true;
      shaped = {};
      break;
    }
    points += more_points;
    corners += more_corners;
  }
  fit_lines(lines, scene.get<MFFloat>(geometry, "length"), scene.get<SFFloat>(geometry, "maxExtent"), style.size);
  if (corners == 0) return mesh;

  // Extents of a line against and in the direction in which lines follow each other.
  const LineEdges edges = style.horizontal ? shaper.edges(style.font) : LineEdges{0.5f, 0.5f};
  const bool forth = style.horizontal ? style.top_to_bottom : style.left_to_right;
  const double step = style.size * style.spacing, block = step * static_cast<double>(lines.size() - 1);
  const double above = edges.above * style.size, below = edges.below * style.size;
  const double first_line =
      minor_start(style.minor, style.horizontal, forth ? above : below, forth ? below : above, block);
  const double minor_sign = style.horizontal == forth ? -1.0 : 1.0;  // lines follow each other downwards or to the left
  const bool forward = direction == TextDirection::right || direction == TextDirection::up;

  glm::dvec2 origin(0);  // origin of the first string, where textures begin (6.47.3)
  glm::vec3* position = mesh.positions.prepare(points);
  if (options.texture_coordinates && options.text_level != kTextPictures) mesh.pictured = false;
  glm::vec2* coordinate =
      options.texture_coordinates || mesh.pictured ? mesh.texture_coordinates.prepare(points) : nullptr;
  std::uint32_t* index = mesh.indices.prepare(corners);
  std::uint32_t made = 0;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const Line& line = lines[i];
    const double start = (forward ? 1 : -1) * major_start(style.major, line.extent);
    const double place = minor_sign * (first_line + step * static_cast<double>(i));
    const glm::dvec2 from = style.horizontal ? glm::dvec2(start, place) : glm::dvec2(place, start);
    if (i == 0) origin = from;
    const glm::dvec2 scale =
        style.size * (style.horizontal ? glm::dvec2(line.stretch, 1) : glm::dvec2(1, line.stretch));
    for (const PlacedGlyph& glyph : line.shaped.glyphs) {
      if (!glyph.shape) continue;
      for (const std::uint32_t corner : glyph.shape->triangles) *index++ = made + corner;
      const bool in_picture = mesh.pictured && glyph.shape->coordinates.size() == glyph.shape->points.size();
      for (std::size_t k = 0; k < glyph.shape->points.size(); ++k) {
        const glm::dvec2 p = from + scale * (glm::dvec2(glyph.at) + glm::dvec2(glyph.shape->points[k]));
        *position++ = glm::vec3(static_cast<float>(p.x), static_cast<float>(p.y), 0);
        if (coordinate) *coordinate++ = in_picture ? glyph.shape->coordinates[k] : glm::vec2((p - origin) / style.size);
        ++made;
      }
    }
  }
  mesh.positions.commit(points);
  if (coordinate) mesh.texture_coordinates.commit(points);
  mesh.indices.commit(corners);
  for (const glm::vec3& p : mesh.positions) mesh.bounds.add(p);
  const glm::vec3 size = mesh.bounds.size();
  if (!std::isfinite(size.x) || !std::isfinite(size.y)) return {};  // the size is too large for a float
  glm::vec3* normal = mesh.normals.prepare(points);
  std::fill_n(normal, points, glm::vec3(0, 0, 1));
  mesh.normals.commit(points);
  mesh.font_size = static_cast<float>(style.size);
  mesh.in_points = style.in_points;
  return mesh;
}

}  // namespace gs::vrml
