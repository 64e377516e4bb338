#include "app/formats/gltf/gltf_material.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {
namespace {

constexpr float kDielectric = 0.04f;  // reflectance of non-metals (glTF 2.0 3.9.2)

float part(const std::vector<double>& factor, std::size_t i, double otherwise) {
  return std::clamp(finite_float(i < factor.size() ? factor[i] : otherwise), 0.0f, 1.0f);
}

vrml::Color display(const glm::vec3& linear) {
  return {display_of_linear(linear.x), display_of_linear(linear.y), display_of_linear(linear.z)};
}

glm::vec3 base_color(const tinygltf::Material& material) {
  const std::vector<double>& f = material.pbrMetallicRoughness.baseColorFactor;
  return {part(f, 0, 1), part(f, 1, 1), part(f, 2, 1)};
}

float transparency(const tinygltf::Material& material) {
  const float alpha = part(material.pbrMetallicRoughness.baseColorFactor, 3, 1);
  if (material.alphaMode == "BLEND") return 1 - alpha;
  if (material.alphaMode == "MASK") return alpha < finite_float(material.alphaCutoff) ? 1.0f : 0.0f;
  return 0;
}

double number_of(const tinygltf::Value& object, const std::string& key, double otherwise) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& value = object.Get(key);
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

glm::vec2 vector_of(const tinygltf::Value& object, const std::string& key, glm::vec2 otherwise) {
  if (!object.Has(key)) return otherwise;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() < 2 || !value.Get(0).IsNumber() || !value.Get(1).IsNumber())
    return otherwise;
  return {finite_float(value.Get(0).GetNumberAsDouble()), finite_float(value.Get(1).GetNumberAsDouble())};
}

/// Returns the texture and coordinates of a TextureInfo, NormalTextureInfo or OcclusionTextureInfo.
template <class Info>
GltfMap map_of(const Info& info) {
  GltfMap map{info.index, info.texCoord, {}};
  const auto extension = info.extensions.find("KHR_texture_transform");
  if (extension == info.extensions.end() || !extension->second.IsObject()) return map;
  const tinygltf::Value& value = extension->second;
  GltfTextureTransform transform;
  transform.offset = vector_of(value, "offset", transform.offset);
  transform.scale = vector_of(value, "scale", transform.scale);
  transform.rotation = finite_float(number_of(value, "rotation", 0));
  if (value.Has("texCoord") && value.Get("texCoord").IsInt()) map.set = value.Get("texCoord").Get<int>();
  map.transform = transform;
  return map;
}

/// Returns the texture that determines the coordinates of a physical material.
GltfMap first_map(const tinygltf::Material& material) {
  const auto& pbr = material.pbrMetallicRoughness;
  for (const GltfMap& map :
       {map_of(pbr.baseColorTexture), map_of(material.normalTexture), map_of(pbr.metallicRoughnessTexture),
        map_of(material.emissiveTexture), map_of(material.occlusionTexture)})
    if (map.texture >= 0) return map;
  return {};
}

/// Appends base64 (RFC 4648 4).
void append_base64(std::string& to, std::span<const unsigned char> bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  to.reserve(to.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(bytes.size() - i, 3);
    unsigned group = static_cast<unsigned>(bytes[i]) << 16;
    if (left > 1) group |= static_cast<unsigned>(bytes[i + 1]) << 8;
    if (left > 2) group |= bytes[i + 2];
    to += kDigits[group >> 18];
    to += kDigits[group >> 12 & 63];
    to += left > 1 ? kDigits[group >> 6 & 63] : '=';
    to += left > 2 ? kDigits[group & 63] : '=';
  }
}

std::string_view mime_type(std::span<const unsigned char> bytes) {
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 8));
  if (start.starts_with("\x89PNG")) return "image/png";
  if (start.starts_with("\xff\xd8")) return "image/jpeg";
  if (start.starts_with("GIF8")) return "image/gif";
  return "application/octet-stream";
}

}  // namespace

float finite_float(double value) {
  constexpr double kMax = std::numeric_limits<float>::max();
  return std::isnan(value) ? 0.0f : static_cast<float>(std::clamp(value, -kMax, kMax));
}

glm::vec2 GltfTextureTransform::apply(glm::vec2 uv) const {
  const glm::vec2 scaled = uv * scale;
  const float c = std::cos(rotation), s = std::sin(rotation);
  return offset + glm::vec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

const tinygltf::Material* GltfMaterials::find(int material) const {
  static const tinygltf::Material kDefault;
  if (material < 0 || static_cast<std::size_t>(material) >= model_.materials.size()) return &kDefault;
  return &model_.materials[static_cast<std::size_t>(material)];
}

GltfSurface GltfMaterials::surface(int index) const {
  const tinygltf::Material& material = *find(index);
  const GltfMap map =
      is_physical(material) ? first_map(material) : map_of(material.pbrMetallicRoughness.baseColorTexture);
  GltfSurface surface;
  surface.double_sided = material.doubleSided;
  surface.textured = map.texture >= 0;
  surface.has_base = material.pbrMetallicRoughness.baseColorTexture.index >= 0;
  surface.texture_set = map.set;
  surface.transform = map.transform;
  surface.factor = base_color(material);
  return surface;
}

bool GltfMaterials::is_physical(const tinygltf::Material& material) const {
  return builder_.scene().language() == vrml::Language::x3d && !material.extensions.contains("KHR_materials_unlit");
}

vrml::NodeId GltfMaterials::appearance(int index, bool glows) {
  const bool known = index >= 0 && static_cast<std::size_t>(index) < model_.materials.size();
  const auto [entry, added] = appearances_.try_emplace({known ? index : -1, glows});
  if (!added) return entry->second;
  const tinygltf::Material& material = *find(index);
  entry->second = is_physical(material) && !glows ? physical(material) : builder_.appearance(look(material, glows));
  builder_.name(entry->second, material.name);
  return entry->second;
}

Look GltfMaterials::look(const tinygltf::Material& material, bool glows) {
  const auto& pbr = material.pbrMetallicRoughness;
  const bool measured = pbr.metallicRoughnessTexture.index >= 0;
  // A texture defines how metallic the surface is. Assume half.
  const float metal = std::clamp(finite_float(pbr.metallicFactor), 0.0f, 1.0f) * (measured ? 0.5f : 1.0f);
  const float rough = std::clamp(finite_float(pbr.roughnessFactor), 0.0f, 1.0f) * (measured ? 0.7f : 1.0f);
  const glm::vec3 base = base_color(material);
  Look look;
  look.diffuse = display(base);
  // Metal shows its colour by reflection. VRML97 has no environment map, so part of the colour must stay diffuse.
  const glm::vec3 reflected = (1 - metal) * glm::vec3(kDielectric) + metal * base;
  look.specular = display(reflected * (1 - rough));
  look.shininess = std::clamp((1 - rough) * (1 - rough), 0.02f, 1.0f);
  // With an emissive texture, the factor alone would make the whole surface glow.
  if (material.emissiveTexture.index < 0)
    look.emissive = display({part(material.emissiveFactor, 0, 0), part(material.emissiveFactor, 1, 0),
                             part(material.emissiveFactor, 2, 0)});
  look.transparency = transparency(material);
  const bool unlit = material.extensions.contains("KHR_materials_unlit");
  add_texture(pbr.baseColorTexture.index, look);
  if (unlit && !look.texture_url.empty()) look.lit = false;
  return unlit || glows ? glowing(look) : look;
}

// Returns an X3D Appearance with a PhysicalMaterial, which has the parameters and maps of glTF.
vrml::NodeId GltfMaterials::physical(const tinygltf::Material& material) {
  using vrml::NodeKind;
  const auto& pbr = material.pbrMetallicRoughness;
  const vrml::NodeId made = builder_.make(vrml::x3d_node_type(NodeKind::physical_material));
  builder_.set(made, "baseColor", display(base_color(material)));
  builder_.set(made, "metallic", std::clamp(finite_float(pbr.metallicFactor), 0.0f, 1.0f));
  builder_.set(made, "roughness", std::clamp(finite_float(pbr.roughnessFactor), 0.0f, 1.0f));
  builder_.set(made, "emissiveColor",
               display({part(material.emissiveFactor, 0, 0), part(material.emissiveFactor, 1, 0),
                        part(material.emissiveFactor, 2, 0)}));
  builder_.set(made, "normalScale", std::max(finite_float(material.normalTexture.scale), 0.0f));
  builder_.set(made, "occlusionStrength", std::clamp(finite_float(material.occlusionTexture.strength), 0.0f, 1.0f));
  if (material.alphaMode != "OPAQUE") builder_.set(made, "transparency", 1 - part(pbr.baseColorFactor, 3, 1));
  const GltfMap first = first_map(material);
  add_map(made, "baseTexture", map_of(pbr.baseColorTexture), first);
  add_map(made, "metallicRoughnessTexture", map_of(pbr.metallicRoughnessTexture), first);
  add_map(made, "normalTexture", map_of(material.normalTexture), first);
  add_map(made, "occlusionTexture", map_of(material.occlusionTexture), first);
  add_map(made, "emissiveTexture", map_of(material.emissiveTexture), first);
  const vrml::NodeId appearance = builder_.make(vrml::x3d_node_type(NodeKind::appearance));
  builder_.set(appearance, "material", made);
  builder_.set(appearance, "alphaMode", vrml::String(material.alphaMode));
  builder_.set(appearance, "alphaCutoff", std::clamp(finite_float(material.alphaCutoff), 0.0f, 1.0f));
  return appearance;
}

// Adds a texture to a material. A Shape has the texture coordinates of the first texture only.
void GltfMaterials::add_map(vrml::NodeId material, std::string_view field, const GltfMap& map, const GltfMap& first) {
  if (map.texture < 0) return;
  if (map.set != first.set || map.transform != first.transform) {
    builder_.note("the " + std::string(field) + " with texture coordinates of its own is left out");
    return;
  }
  Look look;
  add_texture(map.texture, look);
  if (look.texture_url.empty()) return;
  const vrml::NodeId texture = builder_.make(vrml::NodeKind::image_texture);
  builder_.set(texture, "url", vrml::MFString{look.texture_url});
  builder_.set(texture, "repeatS", look.repeat_s);
  builder_.set(texture, "repeatT", look.repeat_t);
  builder_.set(material, field, texture);
}

void GltfMaterials::add_texture(int index, Look& look) {
  if (index < 0) return;
  if (static_cast<std::size_t>(index) >= model_.textures.size()) {
    builder_.fail("texture " + std::to_string(index) + " does not exist");
    return;
  }
  const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(index)];
  look.texture_url = image_url(texture.source);
  if (texture.sampler < 0 || static_cast<std::size_t>(texture.sampler) >= model_.samplers.size()) return;
  const tinygltf::Sampler& sampler = model_.samplers[static_cast<std::size_t>(texture.sampler)];
  look.repeat_s = sampler.wrapS != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
  look.repeat_t = sampler.wrapT != TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
}

vrml::String GltfMaterials::image_url(int index) {
  const auto [entry, added] = urls_.try_emplace(index);
  if (!added) return entry->second;
  if (index < 0 || static_cast<std::size_t>(index) >= model_.images.size()) {
    builder_.fail("image " + std::to_string(index) + " does not exist or is of an unknown kind");
    return {};
  }
  const tinygltf::Image& image = model_.images[static_cast<std::size_t>(index)];
  if (!image.uri.empty()) {
    entry->second = vrml::String(image.uri);
    return entry->second;
  }
  const std::span<const unsigned char> bytes =
      image.bufferView >= 0 ? accessors_.view(image.bufferView) : std::span<const unsigned char>(image.image);
  if (bytes.empty() || !accessors_.charge(bytes.size() * 2)) {
    builder_.fail("image " + std::to_string(index) + ": " +
                  (bytes.empty() ? "its bytes are missing in the file" : accessors_.problem()));
    return {};
  }
  std::string url = "data:";
  url += image.mimeType.empty() ? mime_type(bytes) : std::string_view(image.mimeType);
  url += ";base64,";
  append_base64(url, bytes);
  entry->second = vrml::String(url);
  return entry->second;
}

}  // namespace gs::app
