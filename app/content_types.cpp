#include "app/content_types.h"

#include "app/formats/gltf.h"
#include "app/formats/obj.h"
#include "app/formats/ply.h"
#include "app/formats/stl.h"

#include <algorithm>
#include <string>

namespace gs::app {
namespace {

using Bytes = std::span<const std::byte>;

std::string_view text_of(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

bool is_vrml(Bytes bytes) {
  std::string_view text = text_of(bytes);
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text.starts_with("#VRML") || text.starts_with("#vrml") || text.starts_with("#X3D") ||
         text.starts_with("#Inventor");
}
bool is_ply(Bytes bytes) { return text_of(bytes).starts_with("ply\n") || text_of(bytes).starts_with("ply\r"); }
bool is_glb(Bytes bytes) { return text_of(bytes).starts_with("glTF"); }

constexpr ContentType kTypes[] = {
    {"VRML97", "model/vrml", ".wrl .wrz .vrml ", is_vrml, nullptr},
    {"PLY", "application/x-ply", ".ply ", is_ply,
     [](Bytes bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics, const ReadFile&) {
       import_ply(bytes, scene, diagnostics);
     }},
    {"glTF", "model/gltf-binary", ".glb .gltf ", is_glb, import_gltf},
    {"OBJ", "model/obj", ".obj ", nullptr, import_obj},
    {"STL", "model/stl", ".stl ", nullptr,
     [](Bytes bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics, const ReadFile&) {
       import_stl(bytes, scene, diagnostics);
     }},
};

}  // namespace

std::span<const ContentType> content_types() { return kTypes; }

const ContentType& content_type_of(std::string_view path, std::span<const std::byte> bytes) {
  for (const ContentType& type : kTypes)
    if (type.sniff && type.sniff(bytes)) return type;
  std::string name(path);
  std::transform(name.begin(), name.end(), name.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
  if (name.ends_with(".gz")) name.resize(name.size() - 3);
  const std::size_t point = name.rfind('.');
  if (point != std::string::npos) {
    const std::string extension = name.substr(point) + ' ';
    for (const ContentType& type : kTypes)
      if (type.extensions.find(extension) != std::string_view::npos) return type;
  }
  return kTypes[0];
}

}  // namespace gs::app
