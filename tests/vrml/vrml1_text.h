// Worlds of tests in VRML 1.0.
#pragma once

#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace gs::vrml::testing {

/// Writer of VRML 1.0 for scenes that it can express. It lacks the headlight and the ambient intensity of lights, which
/// the caller must take from the scene.
class Vrml1Writer {
 public:
  /// Returns the text of a VRML97 world, or nullopt if VRML 1.0 lacks a node, a field or a value of it.
  static std::optional<std::string> write(const std::string& vrml97) {
    SceneGraph scene("text.wrl");
    Diagnostics diagnostics;
    (void)parse(vrml97, scene, diagnostics);
    Vrml1Writer writer(scene);
    writer.children(scene.roots(), true);
    if (!writer.good_) return std::nullopt;
    return "#VRML V1.0 ascii\nSeparator {\n" + writer.out_ + "}\n";
  }

 private:
  explicit Vrml1Writer(const SceneGraph& scene) : scene_(scene) {}

  template <class T>
  [[nodiscard]] const T& get(NodeId id, std::string_view field) const {
    return scene_.get<T>(id, field);
  }
  [[nodiscard]] NodeId node_in(NodeId id, std::string_view field) const {
    return scene_.resolve(get<SFNode>(id, field));
  }
  [[nodiscard]] const std::string& type(NodeId id) const { return scene_.node(id).type->name; }
  [[nodiscard]] bool is_default(NodeId id, std::string_view field) const {
    const Node& node = scene_.node(id);
    const int slot = node.type->find_field(field)->slot;
    return node.values[slot] == node.type->defaults[slot];
  }
  void need(bool expressible) { good_ = good_ && expressible; }
  void value(std::string_view name, const FieldValue& value) {
    (out_ += ' ') += name;
    print_value(out_ += ' ', value, scene_);
  }
  /// Writes a field, with its name in VRML 1.0.
  void field(NodeId id, std::string_view name, std::string_view old = {}) {
    value(old.empty() ? name : old, scene_.node(id).values[scene_.node(id).type->find_field(name)->slot]);
  }

  // Lights come first, because they light only later nodes.
  void children(const MFNode& nodes, bool top) {
    for (const bool lights : {true, false})
      for (const NodeId each : nodes) {
        const NodeId id = scene_.resolve(each);
        need(static_cast<bool>(id));
        if (id && has(scene_.node(id).type->role, Role::light) == lights) child(id, top);
      }
  }

  void child(NodeId id, bool top) {
    const std::string& kind = type(id);
    if (kind == "NavigationInfo") return need(top && is_default(id, "type") && is_default(id, "visibilityLimit"));
    if (kind == "WorldInfo") return;
    if (kind == "Viewpoint") return viewpoint(id);
    if (has(scene_.node(id).type->role, Role::light)) return light(id, top);
    if (kind == "Inline") return inlined(id);
    if (kind == "Shape" || has(scene_.node(id).type->role, Role::grouping)) return named(id);
    need(false);
  }

  // Writes a Shape or group as Separator. A further use of it becomes a USE.
  void named(NodeId id) {
    const Node& node = scene_.node(id);
    const bool may_name = !node.name.empty() && node.type->kind == NodeType::Kind::built_in && node.instance == 0;
    if (may_name && !seen_.insert(id.index).second) {
      (out_ += "USE ") += std::string(node.name) + '\n';
      return;
    }
    if (may_name) (out_ += "DEF ") += std::string(node.name) + ' ';
    const std::string& kind = type(id);
    if (kind == "Switch") return alternatives(id, "choice", "Switch {", "whichChoice", "whichChild");
    if (kind == "LOD") return alternatives(id, "level", "LOD {", "range", "range");
    out_ += "Separator {\n";
    if (kind == "Shape")
      shape(id);
    else if (kind == "Transform")
      moved(id);
    else if (kind == "Group" || kind == "Anchor" || kind == "Collision")
      children(get<MFNode>(id, "children"), false);
    else
      need(false);
    out_ += "}\n";
  }

  void moved(NodeId id) {
    out_ += "Transform {";
    for (const char* const name : {"translation", "rotation", "scaleOrientation", "center"}) field(id, name);
    field(id, "scale", "scaleFactor");
    out_ += " }\n";
    children(get<MFNode>(id, "children"), false);
  }

  void alternatives(NodeId id, std::string_view list, std::string_view head, std::string_view name,
                    std::string_view old) {
    out_ += head;
    field(id, name, old);
    if (list == "level") field(id, "center");
    out_ += '\n';
    for (const NodeId each : get<MFNode>(id, list)) {
      out_ += "Separator {\n";
      children({each}, false);
      out_ += "}\n";
    }
    out_ += "}\n";
  }

  void inlined(NodeId id) {
    need(get<MFString>(id, "url").size() == 1);
    if (!good_) return;
    out_ += "WWWInline {";
    value("name", SFString(get<MFString>(id, "url")[0]));
    out_ += " }\n";
  }

  void viewpoint(NodeId id) {
    out_ += "PerspectiveCamera {";
    field(id, "position");
    field(id, "orientation");
    field(id, "fieldOfView", "heightAngle");
    out_ += " }\n";
  }

  void light(NodeId id, bool top) {
    const std::string& kind = type(id);
    const bool local = kind != "DirectionalLight", spot = kind == "SpotLight";
    // Local lights of VRML 1.0 have no radius and no attenuation, and light only their Separator.
    need(!local || (top && get<SFVec3f>(id, "attenuation") == SFVec3f(1, 0, 0) && get<SFFloat>(id, "radius") >= 20));
    (out_ += kind) += " {";
    for (const char* const name : {"on", "intensity", "color"}) field(id, name);
    if (local) field(id, "location");
    if (!local || spot) field(id, "direction");
    if (spot) {
      const float cut = get<SFFloat>(id, "cutOffAngle"), beam = get<SFFloat>(id, "beamWidth");
      field(id, "cutOffAngle");
      value("dropOffRate", SFFloat{beam < cut ? 1 - beam / cut : 0});
    }
    out_ += " }\n";
  }

  void shape(NodeId id) {
    const NodeId geometry = node_in(id, "geometry"), appearance = node_in(id, "appearance");
    if (!geometry) return;
    const NodeId material = appearance ? node_in(appearance, "material") : NodeId{};
    const NodeId texture = appearance ? node_in(appearance, "texture") : NodeId{};
    if (!good_) return;
    const std::string& kind = type(geometry);
    const bool lines = kind == "IndexedLineSet" || kind == "PointSet";
    const NodeId color = lines || kind == "IndexedFaceSet" ? node_in(geometry, "color") : NodeId{};
    looks(material, color, lines);
    if (texture) textured(texture, node_in(appearance, "textureTransform"));
    if (kind == "Box")
      box(geometry);
    else if (kind == "Sphere")
      simple(geometry, "Sphere {", {"radius"});
    else if (kind == "Cone")
      solid(geometry, "Cone {", {"side", "bottom"}, {"bottomRadius", "height"});
    else if (kind == "Cylinder")
      solid(geometry, "Cylinder {", {"side", "top", "bottom"}, {"radius", "height"});
    else if (kind == "IndexedFaceSet")
      faces(geometry, static_cast<bool>(color));
    else if (lines)
      lines_or_points(geometry, kind, static_cast<bool>(color));
    else
      need(false);
  }

  void looks(NodeId material, NodeId color, bool lines) {
    const MFColor colors = color ? get<MFColor>(color, "color") : MFColor{};
    out_ += "Material {";
    if (lines || !material) {
      // Lines are not lit, and have the diffuse colour. A Shape without Material has only an emissive colour.
      const MFColor own =
          color ? colors : MFColor{material ? get<SFColor>(material, "emissiveColor") : SFColor{1, 1, 1}};
      if (!lines)
        for (const char* const name : {"ambientColor", "diffuseColor", "specularColor"}) value(name, MFColor{});
      value(lines ? "diffuseColor" : "emissiveColor", own);
      out_ += " }\n";
      return;
    }
    MFColor ambient;
    const MFColor diffuse = color ? colors : MFColor{get<SFColor>(material, "diffuseColor")};
    const float part = get<SFFloat>(material, "ambientIntensity");
    for (const SFColor& one : diffuse) ambient.push_back({one.r * part, one.g * part, one.b * part});
    value("ambientColor", ambient);
    value("diffuseColor", diffuse);
    for (const char* const name : {"specularColor", "emissiveColor", "shininess", "transparency"})
      field(material, name);
    out_ += " }\n";
  }

  void textured(NodeId texture, NodeId transform) {
    if (type(texture) == "PixelTexture") {
      out_ += "Texture2 {";
      field(texture, "image");
    } else {
      need(type(texture) == "ImageTexture" && get<MFString>(texture, "url").size() == 1);
      if (!good_) return;
      out_ += "Texture2 {";
      value("filename", SFString(get<MFString>(texture, "url")[0]));
    }
    if (!get<SFBool>(texture, "repeatS")) out_ += " wrapS CLAMP";
    if (!get<SFBool>(texture, "repeatT")) out_ += " wrapT CLAMP";
    out_ += " }\n";
    if (!transform) return;
    // VRML97 applies the translation first (6.49), VRML 1.0 last.
    const SFVec2f center = get<SFVec2f>(transform, "center");
    const auto step = [&](std::string_view name, const FieldValue& of) {
      out_ += "Texture2Transform {";
      value(name, of);
      out_ += " }\n";
    };
    step("translation", SFVec2f(-center));
    step("scaleFactor", get<SFVec2f>(transform, "scale"));
    step("rotation", get<SFFloat>(transform, "rotation"));
    step("translation", SFVec2f(center));
    step("translation", get<SFVec2f>(transform, "translation"));
  }

  void simple(NodeId id, std::string_view head, std::initializer_list<const char*> names) {
    out_ += head;
    for (const char* const name : names) field(id, name);
    out_ += " }\n";
  }
  // Open solids of VRML 1.0 show their inner sides.
  void solid(NodeId id, std::string_view head, std::initializer_list<const char*> parts,
             std::initializer_list<const char*> names) {
    for (const char* const part : parts) need(get<SFBool>(id, part));
    simple(id, head, names);
  }
  void box(NodeId id) {
    const SFVec3f& size = get<SFVec3f>(id, "size");
    out_ += "Cube {";
    value("width", SFFloat{size.x});
    value("height", SFFloat{size.y});
    value("depth", SFFloat{size.z});
    out_ += " }\n";
  }

  void coordinates(NodeId geometry) {
    const NodeId coord = node_in(geometry, "coord");
    need(static_cast<bool>(coord));
    if (!coord) return;
    out_ += "Coordinate3 {";
    field(coord, "point");
    out_ += " }\n";
  }
  void binding(std::string_view node, std::string_view word) { ((((out_ += node) += " { value ") += word) += " }\n"); }
  void index(NodeId id, std::string_view name, std::string_view otherwise, std::string_view old) {
    field(id, get<MFInt32>(id, name).empty() && !otherwise.empty() ? otherwise : name, old);
  }

  void faces(NodeId id, bool colored) {
    coordinates(id);
    const NodeId normal = node_in(id, "normal"), texture = node_in(id, "texCoord");
    const bool vertex = get<SFBool>(id, "normalPerVertex"), color_vertex = get<SFBool>(id, "colorPerVertex");
    const bool has_index = !get<MFInt32>(id, "colorIndex").empty();
    out_ += "ShapeHints { vertexOrdering ";
    out_ += get<SFBool>(id, "ccw") ? "COUNTERCLOCKWISE" : "CLOCKWISE";
    out_ += get<SFBool>(id, "solid") ? " shapeType SOLID" : " shapeType UNKNOWN_SHAPE_TYPE";
    out_ += get<SFBool>(id, "convex") ? " faceType CONVEX" : " faceType UNKNOWN_FACE_TYPE";
    field(id, "creaseAngle");
    out_ += " }\n";
    if (normal) {
      out_ += "Normal {";
      field(normal, "vector");
      out_ += " }\n";
      binding("NormalBinding", vertex                                    ? "PER_VERTEX_INDEXED"
                               : get<MFInt32>(id, "normalIndex").empty() ? "PER_FACE"
                                                                         : "PER_FACE_INDEXED");
    }
    if (texture) {
      out_ += "TextureCoordinate2 {";
      field(texture, "point");
      out_ += " }\n";
    }
    if (colored)
      binding("MaterialBinding", color_vertex ? "PER_VERTEX_INDEXED" : has_index ? "PER_FACE_INDEXED" : "PER_FACE");
    out_ += "IndexedFaceSet {";
    field(id, "coordIndex");
    if (normal && vertex) index(id, "normalIndex", "coordIndex", "normalIndex");
    if (normal && !vertex && !get<MFInt32>(id, "normalIndex").empty()) field(id, "normalIndex");
    if (texture) index(id, "texCoordIndex", "coordIndex", "textureCoordIndex");
    if (colored && color_vertex) index(id, "colorIndex", "coordIndex", "materialIndex");
    if (colored && !color_vertex && has_index) field(id, "colorIndex", "materialIndex");
    out_ += " }\n";
  }

  void lines_or_points(NodeId id, const std::string& kind, bool colored) {
    coordinates(id);
    if (kind == "PointSet") {
      if (colored) binding("MaterialBinding", "PER_VERTEX");
      out_ += "PointSet { }\n";
      return;
    }
    const bool vertex = get<SFBool>(id, "colorPerVertex"), has_index = !get<MFInt32>(id, "colorIndex").empty();
    if (colored)
      binding("MaterialBinding", vertex ? "PER_VERTEX_INDEXED" : has_index ? "PER_FACE_INDEXED" : "PER_FACE");
    out_ += "IndexedLineSet {";
    field(id, "coordIndex");
    if (colored && vertex) index(id, "colorIndex", "coordIndex", "materialIndex");
    if (colored && !vertex && has_index) field(id, "colorIndex", "materialIndex");
    out_ += " }\n";
  }

  const SceneGraph& scene_;
  std::string out_;
  std::set<std::uint32_t> seen_;
  bool good_ = true;
};

}  // namespace gs::vrml::testing
