#include "app/saving/scene_formats.h"

#include "app/formats/export/export.h"
#include "base/text.h"

#include <algorithm>
#include <iterator>

namespace gs::app {
namespace {

constexpr SceneFormat kSceneFormats[] = {
    {"VRML97", ".wrl .vrml .wrz .wrl.gz ", vrml::Grammar::vrml97},
    {"X3D XML", ".x3d .x3dz .x3d.gz ", vrml::Grammar::x3d_xml},
    {"X3D classic", ".x3dv .x3dvz .x3dv.gz ", vrml::Grammar::x3d_classic},
    {"X3D JSON", ".x3dj .x3djz .x3dj.gz ", vrml::Grammar::x3d_json},
};
constexpr std::string_view kPackedExtensions = ".wrz .x3dz .x3dvz .x3djz .gz ";

// Returns the extension of a list that ends the path, or an empty text.
std::string_view extension_in(std::string_view extensions, std::string_view lower_path) {
  while (!extensions.empty()) {
    const std::string_view one = extensions.substr(0, extensions.find(' '));
    if (lower_path.ends_with(one)) return one;
    extensions.remove_prefix(one.size() + 1);
  }
  return {};
}

}  // namespace

std::span<const SceneFormat> scene_formats() { return kSceneFormats; }

const SceneFormat* scene_format_of(std::string_view path) {
  const std::string lower = lower_case(std::string(path));
  for (const SceneFormat& format : kSceneFormats) {
    const std::string_view extension = extension_in(format.extensions, lower);
    if (extension.empty()) continue;
    const ExportFormat* const vectors = export_format_of(lower);
    return vectors && vectors->extension.size() > extension.size() ? nullptr : &format;
  }
  return nullptr;
}

const SceneFormat& scene_format_of(vrml::Grammar grammar) {
  return *std::find_if(std::begin(kSceneFormats), std::end(kSceneFormats),
                       [&](const SceneFormat& format) { return format.grammar == grammar; });
}

bool is_packed_path(std::string_view path) {
  return !extension_in(kPackedExtensions, lower_case(std::string(path))).empty();
}

std::string scene_format_list() {
  std::string text;
  for (const SceneFormat& format : kSceneFormats)
    text += (text.empty() ? "" : ", ") + std::string(format.extension()) + " (" + std::string(format.name) + ")";
  return text;
}

}  // namespace gs::app
