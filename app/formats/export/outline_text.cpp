#include "app/formats/export/outline_text.h"

#include "app/formats/export/vrml_text.h"
#include "base/text.h"
#include "vrml/syntax/printer.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace gs::app {
namespace {

/// PROTO for browsers without OutlineGroup, with only the necessary part of its interface; see vrml/nodes/geometry.cpp.
constexpr std::string_view kFallback =
    "PROTO OutlineGroup [\n"
    "  exposedField SFNode refines NULL\n"
    "  field SFFloat creaseAngle 0\n"
    "  field SFBool solid TRUE\n"
    "  field MFInt32 outlineGroup []\n"
    "  field MFInt32 groupSize []\n"
    "  field MFVec3f outline []\n"
    "  field MFInt32 outlineIndex []\n"
    "  field MFInt32 group []\n"
    "  field MFVec3f point []\n"
    "  field MFInt32 coordIndex []\n"
    "  field MFVec2f texCoord []\n"
    "  field MFVec2f outlineTexCoord []\n"
    "] {\n"
    "  IndexedFaceSet {\n"
    "    coord Coordinate { point IS point }\n    coordIndex IS coordIndex\n"
    "    texCoord TextureCoordinate { point IS texCoord }\n"
    "    creaseAngle IS creaseAngle\n    solid IS solid\n    convex FALSE\n  }\n}\n";
/// Lines for textures. Worlds without textures omit them, because an empty TextureCoordinate would disable the default
/// mapping.
constexpr std::string_view kTextureField = "  field MFVec2f texCoord []\n  field MFVec2f outlineTexCoord []\n";
constexpr std::string_view kTextureUse = "    texCoord TextureCoordinate { point IS texCoord }\n";

constexpr std::size_t kFirstBatch = 128, kBatchGrowth = 4;  // groups in the first node; factor per further node

class OutlineText {
 public:
  explicit OutlineText(std::string& out) : out_(out) {}
  OutlineText& operator<<(std::string_view text) {
    out_ += text;
    return *this;
  }
  OutlineText& operator<<(float value) {
    append_number(out_, value);
    return *this;
  }
  OutlineText& operator<<(std::size_t value) {
    out_ += std::to_string(value);
    return *this;
  }
  void quoted(std::string_view text) { append_quoted(out_, text); }

 private:
  std::string& out_;
};

/// Field text of one of the two polygon lists of a node: outlines, or inner polygons.
struct List {
  std::string index, points, coordinates, groups;
  std::size_t corners = 0;

  void add(const qnv::OutlinePolygon& polygon, std::size_t group) {
    OutlineText index_text(index), point_text(points), coordinate_text(coordinates), group_text(groups);
    // A bridged ring visits some corners twice. Write each corner only once.
    for (const std::uint32_t corner : qnv::bridged_ring(polygon)) index_text << corners + corner << " ";
    index += "-1\n";
    for (const glm::vec3& p : polygon.positions) point_text << p.x << " " << p.y << " " << p.z << "\n";
    for (const glm::vec2& p : polygon.texture_coordinates) coordinate_text << p.x << " " << p.y << "\n";
    if (polygon.texture_coordinates.empty() && !coordinates.empty())
      for (std::size_t i = 0; i < polygon.positions.size(); ++i) coordinates += "0 0\n";
    corners += polygon.positions.size();
    group_text << group << "\n";
  }
};

/// Outline groups in the same node.
struct Batch {
  std::uint32_t appearance = 0;
  std::size_t number = 0;
  std::vector<const qnv::OutlineGroup*> groups;
};

void put_color(OutlineText& text, const char* field, const qnv::Rgb8& color) {
  text << field;
  for (const std::uint8_t c : {color.r, color.g, color.b})
    text << " " << std::round(static_cast<float>(c) / 0.255f) / 1000;
}

void put_appearance(OutlineText& text, const qnv::OutlineAppearance& look, std::size_t number) {
  const auto part = [](std::uint8_t v) { return std::round(static_cast<float>(v) / 0.255f) / 1000; };
  text << "DEF A" << number << " Appearance {\n";
  if (look.lit) {
    put_color(text, "    material Material { diffuseColor", look.diffuse);
    if (look.emissive != qnv::Rgb8{0, 0, 0}) put_color(text, " emissiveColor", look.emissive);
    if (look.specular != qnv::Rgb8{0, 0, 0}) put_color(text, " specularColor", look.specular);
    if (look.ambient_intensity != 51) text << " ambientIntensity " << part(look.ambient_intensity);
    if (look.shininess != 51) text << " shininess " << part(look.shininess);
    if (look.transparency != 0) text << " transparency " << part(look.transparency);
    text << " }\n";
  } else if (look.diffuse != qnv::Rgb8{255, 255, 255}) {
    put_color(text, "    material Material { diffuseColor 0 0 0 ambientIntensity 0 emissiveColor", look.diffuse);
    text << " }\n";
  }
  if (look.textured) {
    text << "    texture ImageTexture { url ";
    text.quoted(look.texture_url);
    text << " }\n";
  }
  text << "  }";
}

class Writer {
 public:
  Writer(const qnv::OutlineGroups& groups, std::span<const qnv::OutlineAppearance> appearances)
      : appearances_(appearances), used_(appearances.size()) {
    // The groups are in descending order of size; each batch becomes a node. The first batches are small, so that they
    // load soon. Smoothly shaded groups of an appearance stay in one node, because shading needs their neighbours.
    std::vector<std::size_t> open(appearances.size(), kNone), room(appearances.size(), kFirstBatch);
    for (const qnv::OutlineGroup& group : groups.groups) {
      std::size_t& at = open[group.appearance];
      if (at == kNone) {
        at = batches_.size();
        batches_.push_back({group.appearance, batches_.size(), {}});
      }
      batches_[at].groups.push_back(&group);
      if (appearances[group.appearance].crease_angle > 0 || batches_[at].groups.size() < room[group.appearance])
        continue;
      at = kNone;
      room[group.appearance] *= kBatchGrowth;
    }
  }

  void outlines(std::string& out) {
    for (const Batch& batch : batches_) {
      List stays, outline;
      std::string sizes;
      bool any_inner = false;
      for (std::size_t i = 0; i < batch.groups.size(); ++i) {
        const qnv::OutlineGroup& group = *batch.groups[i];
        List& list = group.inner.empty() ? stays : outline;
        for (std::size_t k = 0; k < group.outline.size(); ++k) list.add(group.outline[k], i);
        OutlineText(sizes) << group.inner.size() << " ";
        any_inner = any_inner || !group.inner.empty();
      }
      OutlineText text(out);
      head(text, batch);
      if (any_inner) text << "  groupSize [ " << sizes << "]\n  outlineGroup [\n" << outline.groups << "  ]\n";
      put(text, "outlineIndex", "outline", {}, outline);
      put(text, "coordIndex", "point", "texCoord", stays);
      text << "} }\n";
    }
  }

  void inner(std::string& out) {
    for (const Batch& batch : batches_) {
      List list;
      for (std::size_t i = 0; i < batch.groups.size(); ++i)
        for (std::size_t k = 0; k < batch.groups[i]->inner.size(); ++k) list.add(batch.groups[i]->inner[k], i);
      if (list.corners == 0) continue;
      OutlineText text(out);
      text << "Shape { appearance USE A" << std::size_t{batch.appearance} << " geometry OutlineGroup {\n";
      look(text, batch);
      text << "  refines USE O" << batch.number << "\n  group [\n" << list.groups << "  ]\n";
      put(text, "coordIndex", "point", "texCoord", list);
      text << "} }\n";
    }
  }

 private:
  static constexpr std::size_t kNone = ~std::size_t{0};

  void look(OutlineText& text, const Batch& batch) {
    const qnv::OutlineAppearance& appearance = appearances_[batch.appearance];
    if (appearance.crease_angle > 0) text << "  creaseAngle " << appearance.crease_angle << "\n";
    if (!appearance.solid) text << "  solid FALSE\n";
  }
  void head(OutlineText& text, const Batch& batch) {
    text << "Shape { appearance ";
    if (used_[batch.appearance])
      text << "USE A" << std::size_t{batch.appearance};
    else
      put_appearance(text, appearances_[batch.appearance], batch.appearance);
    used_[batch.appearance] = true;
    text << " geometry DEF O" << batch.number << " OutlineGroup {\n";
    look(text, batch);
  }
  static void put(OutlineText& text, std::string_view index, std::string_view points, std::string_view coordinates,
                  const List& list) {
    if (list.corners == 0) return;
    text << "  " << index << " [\n" << list.index << "  ]\n";
    if (!coordinates.empty() && !list.coordinates.empty())
      text << "  " << coordinates << " [\n" << list.coordinates << "  ]\n";
    text << "  " << points << " [\n" << list.points << "  ]\n";
  }

  std::span<const qnv::OutlineAppearance> appearances_;
  std::vector<bool> used_;
  std::vector<Batch> batches_;
};

std::string fallback(bool textured) {
  std::string text(kFallback);
  if (textured) return text;
  for (const std::string_view line : {kTextureField, kTextureUse}) text.erase(text.find(line), line.size());
  return text;
}

std::string begun(const std::string& title, bool textured) {
  std::string out = "#VRML V2.0 utf8 outlines, written by GhostSpace\n";
  OutlineText text(out);
  if (!title.empty()) {
    text << "WorldInfo { title ";
    text.quoted(title);
    text << " }\n";
  }
  text << "NavigationInfo { type [ \"EXAMINE\", \"ANY\" ] }\n" << fallback(textured);
  return out;
}

}  // namespace

std::vector<std::byte> outline_world(const qnv::OutlineGroups& groups,
                                     std::span<const qnv::OutlineAppearance> appearances, const std::string& title,
                                     const std::string& viewpoint) {
  std::string out = begun(title, std::any_of(appearances.begin(), appearances.end(),
                                             [](const auto& look) { return look.textured; })) +
                    viewpoint;
  Writer writer(groups, appearances);
  writer.outlines(out);
  writer.inner(out);
  return copied_bytes(out);
}

std::vector<std::byte> outline_world(const vrml::SceneGraph& scene, const std::string& title) {
  const std::string nodes = vrml::print(scene);
  return copied_bytes(begun(title, nodes.find("exCoord") != std::string::npos) + nodes.substr(nodes.find('\n') + 1));
}

}  // namespace gs::app
