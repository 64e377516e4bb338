#pragma once

#include "vrml/scene/x3d/language.h"

#include <span>
#include <string>
#include <string_view>

namespace gs::app {

/// Text format in which a scene is written with all its nodes.
struct SceneFormat {
  std::string_view name;        // "X3D XML"
  std::string_view extensions;  // lower case, a blank behind each: ".x3d .x3dz "; the first one is the usual one
  vrml::Grammar grammar;

  [[nodiscard]] std::string_view extension() const { return extensions.substr(0, extensions.find(' ')); }
};

[[nodiscard]] std::span<const SceneFormat> scene_formats();
/// Returns the format with the extension of a path, in any case. Returns null if no extension matches, and for
/// `.patches.wrl`, which is a format of vectors.
[[nodiscard]] const SceneFormat* scene_format_of(std::string_view path);
/// Returns the format of a grammar.
[[nodiscard]] const SceneFormat& scene_format_of(vrml::Grammar grammar);
/// Reports whether a path has an extension of gzip-compressed text: `.wrz`, `.x3dz`, `.gz`, ...
[[nodiscard]] bool is_packed_path(std::string_view path);
/// Returns the list of formats for help texts: ".wrl (VRML97), .x3d (X3D XML), ...".
[[nodiscard]] std::string scene_format_list();

}  // namespace gs::app
