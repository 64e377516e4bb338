#include "app/formats/gltf/gltf_losses.h"

#include "app/formats/common/byte_order.h"
#include "app/formats/gltf/glb.h"
#include "base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdint>
#include <set>

namespace gs::app {
namespace {

using LossJson = nlohmann::json;

/// Returns the JSON text of a .gltf or .glb file.
std::string_view json_of(std::span<const std::byte> bytes) {
  constexpr std::size_t kStart = 20;
  if (!text_of(bytes).starts_with("glTF") || bytes.size() < kStart) return text_of(bytes);
  return text_of(bytes).substr(kStart, load_little<std::uint32_t>(bytes.data() + 12));
}

/// Adds the names of the properties of a material that are lost.
void add_lost(const LossJson& material, std::set<std::string>& lost) {
  if (!material.is_object()) return;
  if (material.contains("normalTexture")) lost.insert("normal maps");
  if (material.contains("occlusionTexture")) lost.insert("occlusion maps");
  if (material.contains("emissiveTexture")) lost.insert("emissive maps");
  const auto metal = material.find("pbrMetallicRoughness");
  if (metal != material.end() && metal->is_object() && metal->contains("metallicRoughnessTexture"))
    lost.insert("metallic and roughness maps");
  const auto extensions = material.find("extensions");
  if (extensions != material.end() && extensions->is_object())
    for (const auto& [name, value] : extensions->items())
      if (name != "KHR_materials_unlit") lost.insert(shortened(name, 40));
}

}  // namespace

std::vector<std::string> gltf_losses(std::span<const std::byte> bytes) {
  const LossJson document = LossJson::parse(json_of(bytes), nullptr, false);
  if (!document.is_object()) return {};
  std::vector<std::string> losses;
  std::set<std::string> lost;
  if (const auto materials = document.find("materials"); materials != document.end() && materials->is_array())
    for (const LossJson& material : *materials) add_lost(material, lost);
  std::string names;
  for (const std::string& name : lost) names += (names.empty() ? "" : ", ") + name;
  if (!names.empty()) losses.push_back("parts of materials are left out: " + names);
  if (const auto animations = document.find("animations");
      animations != document.end() && animations->is_array() && !animations->empty())
    losses.push_back(std::to_string(animations->size()) +
                     (animations->size() == 1 ? " animation is" : " animations are") +
                     " left out; skins keep their pose");
  return losses;
}

}  // namespace gs::app
