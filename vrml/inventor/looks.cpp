#include "vrml/inventor/looks.h"

#include "vrml/inventor/converter.h"

#include <algorithm>
#include <cmath>

namespace gs::vrml::inventor {
namespace {

template <class T>
T element(const Array<T>& list, std::size_t index, T otherwise) {
  return list.empty() ? otherwise : list[index % list.size()];
}

float unit(float value) { return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 0.0F; }
SFColor unit(SFColor color) { return {unit(color.r), unit(color.g), unit(color.b)}; }

// Returns the factor that makes the ambient colour from the diffuse colour, as closely as possible.
float ambient_intensity(SFColor ambient, SFColor diffuse) {
  const float square = diffuse.r * diffuse.r + diffuse.g * diffuse.g + diffuse.b * diffuse.b;
  if (square <= 0) return 0.2F;
  return unit((ambient.r * diffuse.r + ambient.g * diffuse.g + ambient.b * diffuse.b) / square);
}

// Reports whether only emissive colours are given: precomputed lighting (VRML 1.0, Material).
bool is_precomputed(const MaterialState& material) {
  const bool only_list = material.emissive.size() > 1 && material.diffuse.size() <= 1;
  return !material.emissive.empty() && (material.diffuse.empty() || only_list);
}

}  // namespace

std::string Look::key() const { return material + '|' + std::to_string(texture) + '|' + std::to_string(transform); }

Look Looks::of(const State& state, ShapeKind kind, bool varies, std::size_t index) {
  converter_.read(Part::material);
  converter_.read(Part::light_model);
  converter_.read(Part::texture);
  converter_.read(Part::complexity);
  converter_.read(Part::texture_transform);
  Look look;
  const MaterialState& material = state.material;
  const bool precomputed = is_precomputed(material);
  look.lit = state.lit && kind != ShapeKind::lines && !precomputed;
  look.colors = precomputed ? material.emissive : material.diffuse;
  look.varies = varies && look.colors.size() > 1;
  look.colors_serial = state.serial(Part::material);
  look.index = look.varies ? 0 : index;
  if (kind == ShapeKind::faces && state.textured && state.texture.is_set()) {
    look.texture = state.serial(Part::texture);
    look.transform = state.texture_transform == glm::dmat3(1) ? 0 : state.serial(Part::texture_transform);
  }
  // Without a Material, colours and textures are not lit (VRML97 4.14.2).
  if (!look.lit && (look.varies || look.texture != 0)) return look;
  look.material = std::to_string(state.serial(Part::material)) +
                  (look.lit      ? 'l'
                   : precomputed ? 'p'
                                 : 'u') +
                  std::to_string(look.index);
  return look;
}

void Looks::apply(NodeId shape, const Look& look, const State& state, SourceLocation location) {
  Output& output = converter_.output();
  const NodeTarget target = output.field(shape, "appearance");
  if (look.material.empty() && look.texture == 0) return;
  const std::string key = look.key();
  const auto known = appearances_.find(key);
  if (known != appearances_.end()) return output.place(known->second, target);
  const NodeId appearance = output.begin("Appearance", target, location);
  if (!appearance) return;
  if (!look.material.empty()) add_material(appearance, look, state, location);
  if (look.texture != 0) add_texture(appearance, look, state, location);
  output.end(appearance);
  appearances_.emplace(key, appearance);
  (void)output.scene().memory().charge(key.size() + 64);
}

void Looks::add_material(NodeId appearance, const Look& look, const State& state, SourceLocation location) {
  Output& output = converter_.output();
  const NodeTarget target = output.field(appearance, "material");
  const auto known = materials_.find(look.material);
  if (known != materials_.end()) return output.place(known->second, target);
  const NodeId node = output.begin("Material", target, location);
  if (!node) return;
  const MaterialState& material = state.material;
  const std::size_t i = look.index;
  const SFColor diffuse = unit(element(material.diffuse, i, SFColor{0, 0, 0}));
  const SFColor emissive = unit(element(material.emissive, i, SFColor{0, 0, 0}));
  const float transparency = unit(element(material.transparency, i, 0.0F));
  if (look.lit) {
    output.set(node, "ambientIntensity",
               ambient_intensity(unit(element(material.ambient, i, SFColor{0, 0, 0})), diffuse));
    output.set(node, "diffuseColor", diffuse);
    output.set(node, "specularColor", unit(element(material.specular, i, SFColor{0, 0, 0})));
    output.set(node, "emissiveColor", emissive);
    output.set(node, "shininess", unit(element(material.shininess, i, 0.2F)));
  } else {
    output.set(node, "ambientIntensity", 0.0F);
    output.set(node, "diffuseColor", SFColor{0, 0, 0});
    output.set(node, "emissiveColor", is_precomputed(material) ? emissive : diffuse);
  }
  output.set(node, "transparency", transparency);
  output.end(node);
  if (look.varies && (material.transparency.size() > 1 || (material.emissive.size() > 1 && look.lit)))
    converter_.warn_once(
        location,
        "lists of transparency or emissiveColor are not supported beside diffuseColor; used the first values");
  materials_.emplace(look.material, node);
}

void Looks::add_texture(NodeId appearance, const Look& look, const State& state, SourceLocation location) {
  Output& output = converter_.output();
  const auto known = textures_.find(look.texture);
  if (known != textures_.end()) {
    output.place(known->second, output.field(appearance, "texture"));
  } else {
    const TextureState& texture = state.texture;
    const bool is_file = !texture.file.empty();
    const NodeId node =
        output.begin(is_file ? "ImageTexture" : "PixelTexture", output.field(appearance, "texture"), location);
    if (!node) return;
    if (is_file)
      output.set(node, "url", MFString{texture.file});
    else
      output.set(node, "image", texture.image);
    output.set(node, "repeatS", texture.repeat_s);
    output.set(node, "repeatT", texture.repeat_t);
    output.end(node);
    textures_.emplace(look.texture, node);
  }
  if (look.transform == 0) return;
  const auto transform = transforms_.find(look.transform);
  if (transform != transforms_.end())
    return output.place(transform->second, output.field(appearance, "textureTransform"));
  const NodeId node = output.begin("TextureTransform", output.field(appearance, "textureTransform"), location);
  if (!node) return;
  // VRML97 6.49 without a centre: scale * rotation * translation. The rows of the linear part have the scales as
  // lengths, and must be orthogonal.
  const glm::dmat3& m = state.texture_transform;
  const glm::dvec2 row_s(m[0][0], m[1][0]), row_t(m[0][1], m[1][1]);
  const double scale_s = glm::length(row_s);
  const double determinant = row_s.x * row_t.y - row_s.y * row_t.x;
  if (scale_s > 0 && determinant != 0) {
    const double scale_t = determinant / scale_s;
    const double angle = std::atan2(-row_s.y, row_s.x);
    if (std::abs(glm::dot(row_s, row_t)) > 1e-4 * scale_s * glm::length(row_t))
      converter_.warn_once(location, "Texture2Transform rotates and scales unevenly; approximated");
    const glm::dmat2 linear{glm::dvec2(m[0]), glm::dvec2(m[1])};
    const glm::dvec2 translation = glm::inverse(linear) * glm::dvec2(m[2]);
    output.set(node, "scale", SFVec2f(static_cast<float>(scale_s), static_cast<float>(scale_t)));
    output.set(node, "rotation", static_cast<float>(angle));
    output.set(node, "translation", SFVec2f(translation));
  }
  output.end(node);
  transforms_.emplace(look.transform, node);
}

}  // namespace gs::vrml::inventor
