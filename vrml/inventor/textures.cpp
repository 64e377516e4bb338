#include "vrml/inventor/converter.h"
#include "vrml/inventor/item_types.h"

#include <cmath>
#include <utility>

// Nodes that set textures and their coordinates.
namespace gs::vrml::inventor {
namespace {

void apply_texture(Converter& converter, const Item& item) {
  TextureState texture;
  texture.file = item.get<SFString>("filename");
  texture.image = item.get<SFImage>("image");
  texture.repeat_s = item.word("wrapS") != "CLAMP";
  texture.repeat_t = item.word("wrapT") != "CLAMP";
  std::uint64_t serial = item.serial;
  if (!texture.is_set()) serial = 0;
  // Textures from one file are equal.
  if (!texture.file.empty())
    serial = converter.intern("texture " + std::to_string(texture.repeat_s) + std::to_string(texture.repeat_t) +
                              texture.file.str());
  converter.write(Part::texture, serial).texture = texture;
}

// Multiplies the transform of texture coordinates: translation * centre * rotation * scale * -centre.
void apply_texture_transform(Converter& converter, const Item& item) {
  converter.read(Part::texture_transform);
  const SFVec2f translation = item.get<SFVec2f>("translation"), center = item.get<SFVec2f>("center");
  const SFVec2f scale = item.get<SFVec2f>("scaleFactor");
  const double angle = item.get<SFFloat>("rotation");
  const glm::dmat3 rotation(std::cos(angle), std::sin(angle), 0, -std::sin(angle), std::cos(angle), 0, 0, 0, 1);
  const glm::dmat3 scaling(scale.x, 0, 0, 0, scale.y, 0, 0, 0, 1);
  const auto moved = [](double x, double y) { return glm::dmat3(1, 0, 0, 0, 1, 0, x, y, 1); };
  const glm::dmat3 matrix =
      moved(translation.x + center.x, translation.y + center.y) * rotation * scaling * moved(-center.x, -center.y);
  const glm::dmat3 product = converter.state().texture_transform * matrix;
  std::string key = "texture transform";
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 2; ++row) key += ' ' + std::to_string(product[column][row]);
  const std::uint64_t serial = product == glm::dmat3(1) ? 0 : converter.intern(std::move(key));
  converter.write(Part::texture_transform, serial).texture_transform = product;
}

void set_function(Converter& converter, const TextureFunction& function, std::uint64_t serial) {
  converter.write(Part::texture_function, serial).texture_function = function;
}

void apply_texture_coordinates(Converter& converter, const Item& item) {
  if (item.is_ignored("point")) return;
  set_function(converter, {}, 0);
  converter.write(Part::texture_coordinates, item.serial).texture_points = item.get<MFVec2f>("point");
}

void apply_default_coordinates(Converter& converter, const Item&) {
  set_function(converter, {}, 0);
  converter.write(Part::texture_coordinates, 0).texture_points = {};
}

void apply_plane(Converter& converter, const Item& item) {
  TextureFunction function;
  function.kind = TextureFunction::Kind::plane;
  function.s = item.get<SFVec3f>("directionS");
  function.t = item.get<SFVec3f>("directionT");
  set_function(converter, function, item.serial);
}

void apply_environment_map(Converter& converter, const Item&) {
  TextureFunction function;
  function.kind = TextureFunction::Kind::environment;
  set_function(converter, function, 1);
}

constexpr ItemRow kTextureRows[] = {
    {"Texture2", ItemClass::plain, false, apply_texture, R"(
  SFString filename ""
  SFImage image 0 0 0
  SFEnum wrapS REPEAT
  SFEnum wrapT REPEAT
  SFEnum model MODULATE
  SFColor blendColor 0 0 0
  SFBool enableCompressedTexture FALSE)"},
    {"Texture2Transform", ItemClass::plain, false, apply_texture_transform, R"(
  SFVec2f translation 0 0
  SFFloat rotation 0
  SFVec2f scaleFactor 1 1
  SFVec2f center 0 0)"},
    {"TextureCoordinate2", ItemClass::plain, false, apply_texture_coordinates, "MFVec2f point []"},
    {"TextureCoordinateBinding", ItemClass::plain, false, nullptr, "SFEnum value DEFAULT"},
    {"TextureCoordinateDefault", ItemClass::plain, false, apply_default_coordinates, ""},
    {"TextureCoordinatePlane", ItemClass::plain, false, apply_plane,
     "SFVec3f directionS 1 0 0 SFVec3f directionT 0 1 0"},
    {"TextureCoordinateEnvironment", ItemClass::plain, false, apply_environment_map, ""},
    {"TextureCoordinateSphere TextureCoordinateCylinder TextureCoordinateCube "
     "TextureCoordinateObject TextureCoordinateReflectionMap TextureCoordinateNormalMap",
     ItemClass::plain, false, apply_default_coordinates, "SFVec3f directionS 1 0 0",
     "this function of texture coordinates is not supported; the default mapping is used"},
};

}  // namespace

std::span<const ItemRow> texture_rows() { return kTextureRows; }

}  // namespace gs::vrml::inventor
