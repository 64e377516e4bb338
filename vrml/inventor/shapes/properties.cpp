#include "vrml/inventor/item_types.h"
#include "vrml/inventor/shapes/geometries.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

// Nodes that set the material, the coordinates, the normals and the drawing style of the shapes after them.
namespace gs::vrml::inventor {
namespace {

template <class T>
void append_bytes(std::string& key, const Array<T>& list) {
  key += std::to_string(list.size()) + ':';
  key.append(reinterpret_cast<const char*>(list.data()), list.size() * sizeof(T));
}

// Returns an identity of a material: by value if it is small, so that equal Materials share one node.
std::uint64_t material_serial(Converter& converter, const MaterialState& material, std::uint64_t own) {
  constexpr std::size_t kSmall = 16;
  if (material.diffuse.size() > kSmall || material.emissive.size() > kSmall || material.ambient.size() > kSmall ||
      material.specular.size() > kSmall || material.shininess.size() > kSmall || material.transparency.size() > kSmall)
    return own;
  std::string key = "material ";
  append_bytes(key, material.ambient);
  append_bytes(key, material.diffuse);
  append_bytes(key, material.specular);
  append_bytes(key, material.emissive);
  append_bytes(key, material.shininess);
  append_bytes(key, material.transparency);
  return converter.intern(std::move(key));
}

// Sets the material. `changed` names the fields that it takes from the node; ignored fields keep their values.
void set_material(Converter& converter, const Item& item, const MaterialState& material, bool partial) {
  if (partial) converter.read(Part::material);
  const std::uint64_t own =
      partial ? converter.intern("material " + std::to_string(converter.state().serial(Part::material)) + '+' +
                                 std::to_string(item.serial))
              : item.serial;
  const std::uint64_t serial = material_serial(converter, material, own);
  converter.write(Part::material, serial).material = material;
}

void apply_material(Converter& converter, const Item& item) {
  MaterialState material = converter.state().material;
  bool partial = false;
  const auto take = [&](auto& into, std::string_view field) {
    using List = std::decay_t<decltype(into)>;
    if (item.is_ignored(field))
      partial = true;
    else
      into = item.get<List>(field);
  };
  take(material.ambient, "ambientColor");
  take(material.diffuse, "diffuseColor");
  take(material.specular, "specularColor");
  take(material.emissive, "emissiveColor");
  take(material.shininess, "shininess");
  take(material.transparency, "transparency");
  // Precomputed lighting: a file that gives only emissive colours means these (VRML 1.0, Material).
  set_material(converter, item, material, partial);
}

void apply_base_color(Converter& converter, const Item& item) {
  if (item.is_ignored("rgb")) return;
  MaterialState material = converter.state().material;
  material.diffuse = item.get<MFColor>("rgb");
  set_material(converter, item, material, true);
}

// Sets diffuse colours and transparency from 0xRRGGBBAA.
void set_packed(const MFInt32& packed, MaterialState& material) {
  material.diffuse.clear();
  material.transparency.clear();
  for (const std::int32_t value : packed) {
    const auto rgba = static_cast<std::uint32_t>(value);
    const auto part = [&](unsigned shift) { return static_cast<float>((rgba >> shift) & 255U) / 255.0F; };
    material.diffuse.push_back({part(24), part(16), part(8)});
    material.transparency.push_back(1 - part(0));
  }
  const bool same = std::all_of(material.transparency.begin(), material.transparency.end(),
                                [&](float t) { return t == material.transparency.front(); });
  if (same && !material.transparency.empty()) material.transparency = MFFloat{material.transparency.front()};
}

void apply_packed_color(Converter& converter, const Item& item) {
  if (item.is_ignored("orderedRGBA") || item.is_ignored("rgba")) return;
  const MFInt32& ordered = item.get<MFInt32>("orderedRGBA");
  MaterialState material = converter.state().material;
  set_packed(item.field("rgba") ? item.get<MFInt32>("rgba") : ordered, material);
  set_material(converter, item, material, true);
}

void apply_material_binding(Converter& converter, const Item& item) {
  if (item.is_ignored("value")) return;
  const Binding binding = binding_named(item.word("value"), Binding::overall);
  converter.write(Part::material_binding, 1 + static_cast<std::uint64_t>(binding)).material_binding = binding;
}

void apply_normal_binding(Converter& converter, const Item& item) {
  if (item.is_ignored("value")) return;
  const Binding binding = binding_named(item.word("value"), Binding::per_vertex_indexed);
  converter.write(Part::normal_binding, 1 + static_cast<std::uint64_t>(binding)).normal_binding = binding;
}

void apply_coordinates(Converter& converter, const Item& item) {
  if (item.is_ignored("point")) return;
  State& state = converter.write(Part::coordinates, item.serial);
  state.weights.clear();
  if (item.type->find("point")->type.numbers == 3) {
    state.points = item.get<MFVec3f>("point");
    return;
  }
  // Homogeneous coordinates of Coordinate4.
  const MFFloat& numbers = item.get<MFFloat>("point");
  state.points.clear();
  if (!converter.sink().limits().admits_string(numbers.size() * sizeof(float), item.location)) return;
  state.points.reserve(numbers.size() / 4);
  for (std::size_t i = 0; i + 4 <= numbers.size(); i += 4) {
    const float w = numbers[i + 3] == 0 ? 1 : numbers[i + 3];
    state.weights.push_back(w);
    state.points.push_back({numbers[i] / w, numbers[i + 1] / w, numbers[i + 2] / w});
  }
}

void apply_normals(Converter& converter, const Item& item) {
  if (item.is_ignored("vector")) return;
  converter.write(Part::normals, item.serial).normals = item.get<MFVec3f>("vector");
}

void apply_hints(Converter& converter, const Item& item) {
  HintsState hints = converter.state().hints;
  bool partial = false;
  const auto takes = [&](std::string_view field) {
    const bool ignored = item.is_ignored(field);
    partial |= ignored;
    return !ignored;
  };
  bool ordered = hints.solid;
  if (takes("vertexOrdering")) {
    hints.ccw = item.word("vertexOrdering") != "CLOCKWISE";
    ordered = item.word("vertexOrdering") != "UNKNOWN_ORDERING";
  }
  if (takes("shapeType")) hints.solid = ordered && item.word("shapeType") == "SOLID";
  if (takes("faceType")) hints.convex = item.word("faceType") == "CONVEX";
  if (takes("creaseAngle"))
    hints.crease_angle = item.field("creaseAngle") ? item.get<SFFloat>("creaseAngle") : converter.crease_angle();
  if (item.field("hints")) {  // Inventor 1.0
    const std::string_view mask = item.word("hints");
    const auto has_hint = [&](std::string_view word) { return mask.find(word) != std::string_view::npos; };
    hints.ccw = true;
    hints.solid = has_hint("SOLID") && has_hint("ORDERED");
    hints.convex = has_hint("CONVEX");
  }
  if (partial) converter.read(Part::hints);
  std::string key = "hints ";
  key += std::to_string(hints.ccw) + std::to_string(hints.solid) + std::to_string(hints.convex) +
         std::to_string(hints.crease_angle);
  converter.write(Part::hints, converter.intern(std::move(key))).hints = hints;
}

void apply_draw_style(Converter& converter, const Item& item) {
  if (item.is_ignored("style")) return;
  static constexpr std::pair<std::string_view, DrawStyle> kStyles[] = {
      {"LINES", DrawStyle::lines}, {"POINTS", DrawStyle::points}, {"INVISIBLE", DrawStyle::invisible}};
  DrawStyle style = DrawStyle::filled;
  for (const auto& [name, value] : kStyles)
    if (item.word("style") == name) style = value;
  converter.write(Part::draw_style, 1 + static_cast<std::uint64_t>(style)).draw_style = style;
}

void apply_light_model(Converter& converter, const Item& item) {
  if (item.is_ignored("model")) return;
  const bool lit = item.word("model") != "BASE_COLOR";
  converter.write(Part::light_model, lit ? 1 : 2).lit = lit;
}

void apply_complexity(Converter& converter, const Item& item) {
  if (item.is_ignored("textureQuality")) return;
  const bool textured = item.get<SFFloat>("textureQuality") > 0;
  converter.write(Part::complexity, textured ? 1 : 2).textured = textured;
}

// VRML97 names of the fonts of Inventor.
String family_of(std::string_view name) {
  const auto contains = [&](std::string_view word) { return name.find(word) != std::string_view::npos; };
  if (contains("Helvetica") || contains("Arial") || contains("Sans") || contains("sans") || contains("SANS"))
    return "SANS";
  if (contains("Courier") || contains("Mono") || contains("TYPEWRITER") || contains("Typewriter")) return "TYPEWRITER";
  return "SERIF";
}
String style_of(std::string_view name) {
  const auto contains = [&](std::string_view word) { return name.find(word) != std::string_view::npos; };
  const bool bold = contains("Bold") || contains("BOLD") || contains("bold");
  const bool italic = contains("Italic") || contains("ITALIC") || contains("Oblique") || contains("italic");
  return bold && italic ? "BOLDITALIC" : bold ? "BOLD" : italic ? "ITALIC" : "PLAIN";
}

void apply_font(Converter& converter, const Item& item) {
  FontState font = converter.state().font;
  converter.read(Part::font);
  if (!item.is_ignored("size")) font.size = item.get<SFFloat>("size");
  const bool by_family = item.type->find("family") != nullptr && (item.field("family") || !item.field("name"));
  if (by_family && !item.is_ignored("family")) font.family = family_of(item.word("family"));
  if (!by_family && !item.is_ignored("name")) font.family = family_of(item.word("name"));
  if (item.type->find("style") && !item.is_ignored("style"))
    font.style = style_of(item.word("style"));
  else
    font.style = style_of(item.word("name"));
  const std::string key = "font " + font.family.str() + ' ' + font.style.str() + ' ' + std::to_string(font.size);
  converter.write(Part::font, converter.intern(key)).font = font;
}

void apply_vertex_properties(Converter& converter, const Item& item) {
  State changed = converter.state();
  apply_vertex_property(converter, item, changed);
  for (std::size_t i = 0; i < kParts; ++i) {
    const auto part = static_cast<Part>(i);
    if (changed.serial(part) == converter.state().serial(part)) continue;
    (void)converter.write(part, changed.serial(part));
  }
  converter.write(Part::coordinates, changed.serial(Part::coordinates)) = changed;
}

constexpr ItemRow kPropertyRows[] = {
    {"Material", ItemClass::plain, false, apply_material, R"(
  MFColor ambientColor 0.2 0.2 0.2
  MFColor diffuseColor 0.8 0.8 0.8
  MFColor specularColor 0 0 0
  MFColor emissiveColor 0 0 0
  MFFloat shininess 0.2
  MFFloat transparency 0)"},
    {"BaseColor", ItemClass::plain, false, apply_base_color, "MFColor rgb 0.8 0.8 0.8"},
    {"PackedColor", ItemClass::plain, false, apply_packed_color, "MFUInt32 orderedRGBA 0xccccccff MFLong rgba []"},
    {"MaterialBinding", ItemClass::plain, false, apply_material_binding, "SFEnum value OVERALL"},
    {"NormalBinding", ItemClass::plain, false, apply_normal_binding, "SFEnum value DEFAULT"},
    {"Coordinate3", ItemClass::plain, false, apply_coordinates, "MFVec3f point 0 0 0"},
    {"Coordinate4", ItemClass::plain, false, apply_coordinates, "MFVec4f point [ 0 0 0 1 ]"},
    {"Normal", ItemClass::plain, false, apply_normals, "MFVec3f vector []"},
    {"ShapeHints", ItemClass::plain, false, apply_hints, R"(
  SFEnum vertexOrdering UNKNOWN_ORDERING
  SFEnum shapeType UNKNOWN_SHAPE_TYPE
  SFEnum faceType CONVEX
  SFEnum windingType NO_WINDING_TYPE
  SFFloat creaseAngle 0.5
  SFBitMask hints NONE
  SFBool useVBO TRUE)"},
    {"DrawStyle", ItemClass::plain, false, apply_draw_style, R"(
  SFEnum style FILLED
  SFFloat pointSize 0
  SFFloat lineWidth 0
  SFUShort linePattern 0xffff
  SFInt32 linePatternScaleFactor 1)"},
    {"LightModel", ItemClass::plain, false, apply_light_model, "SFEnum model PHONG"},
    {"Complexity", ItemClass::plain, false, apply_complexity, R"(
  SFEnum type OBJECT_SPACE
  SFFloat value 0.5
  SFFloat textureQuality 0.5)"},
    {"Font", ItemClass::plain, false, apply_font, "SFName name defaultFont SFFloat size 10"},
    {"FontStyle", ItemClass::plain, false, apply_font, R"(
  SFFloat size 10
  SFName name defaultFont
  SFEnum family SERIF
  SFBitMask style NONE)"},
    {"VertexProperty", ItemClass::plain, false, apply_vertex_properties, R"(
  MFVec3f vertex []
  MFVec3f normal []
  SFEnum normalBinding PER_VERTEX_INDEXED
  MFUInt32 orderedRGBA []
  SFEnum materialBinding OVERALL
  MFVec2f texCoord []
  MFVec3f texCoord3 []
  SFNode textureUnit)"},
};

}  // namespace

void apply_vertex_property(Converter& converter, const Item& item, State& state) {
  const auto set_serial = [&](Part part, std::uint64_t serial) {
    state.serials[static_cast<std::size_t>(part)] = serial;
  };
  if (const auto& points = item.get<MFVec3f>("vertex"); !points.empty()) {
    state.points = points;
    state.weights.clear();
    set_serial(Part::coordinates, item.serial);
  }
  if (const auto& normals = item.get<MFVec3f>("normal"); !normals.empty()) {
    state.normals = normals;
    state.normal_binding = binding_named(item.word("normalBinding"), Binding::per_vertex_indexed);
    set_serial(Part::normals, item.serial);
    set_serial(Part::normal_binding, 1 + static_cast<std::uint64_t>(state.normal_binding));
  }
  if (const auto& packed = item.get<MFInt32>("orderedRGBA"); !packed.empty()) {
    set_packed(packed, state.material);
    state.material_binding = binding_named(item.word("materialBinding"), Binding::overall);
    set_serial(Part::material, converter.intern("vertex property " + std::to_string(item.serial) + ' ' +
                                                std::to_string(converter.state().serial(Part::material))));
    set_serial(Part::material_binding, 1 + static_cast<std::uint64_t>(state.material_binding));
  }
  if (const auto& coordinates = item.get<MFVec2f>("texCoord"); !coordinates.empty()) {
    state.texture_points = coordinates;
    state.texture_function = {};
    set_serial(Part::texture_coordinates, item.serial);
    set_serial(Part::texture_function, 0);
  }
}

std::span<const ItemRow> property_rows() { return kPropertyRows; }

}  // namespace gs::vrml::inventor
