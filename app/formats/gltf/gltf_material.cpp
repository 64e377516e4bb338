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
  const tinygltf::TextureInfo& texture = material.pbrMetallicRoughness.baseColorTexture;
  GltfSurface surface;
  surface.double_sided = material.doubleSided;
  surface.textured = texture.index >= 0;
  surface.texture_set = texture.texCoord;
  surface.factor = base_color(material);
  const auto extension = texture.extensions.find("KHR_texture_transform");
  if (extension != texture.extensions.end() && extension->second.IsObject()) {
    const tinygltf::Value& value = extension->second;
    GltfTextureTransform transform;
    transform.offset = vector_of(value, "offset", transform.offset);
    transform.scale = vector_of(value, "scale", transform.scale);
    transform.rotation = finite_float(number_of(value, "rotation", 0));
    if (value.Has("texCoord") && value.Get("texCoord").IsInt()) surface.texture_set = value.Get("texCoord").Get<int>();
    surface.transform = transform;
  }
  return surface;
}

vrml::NodeId GltfMaterials::appearance(int index, bool glows) {
  const bool known = index >= 0 && static_cast<std::size_t>(index) < model_.materials.size();
  const auto [entry, added] = appearances_.try_emplace({known ? index : -1, glows});
  if (!added) return entry->second;
  const tinygltf::Material& material = *find(index);
  entry->second = builder_.appearance(look(material, glows));
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
  add_texture(pbr.baseColorTexture, look);
  if (unlit && !look.texture_url.empty()) look.lit = false;
  return unlit || glows ? glowing(look) : look;
}

void GltfMaterials::add_texture(const tinygltf::TextureInfo& info, Look& look) {
  if (info.index < 0) return;
  if (static_cast<std::size_t>(info.index) >= model_.textures.size()) {
    builder_.fail("texture " + std::to_string(info.index) + " does not exist");
    return;
  }
  const tinygltf::Texture& texture = model_.textures[static_cast<std::size_t>(info.index)];
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
