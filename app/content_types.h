#pragma once

#include "app/formats/read_file.h"
#include "vrml/diagnostic.h"
#include "vrml/scene_graph.h"

#include <cstddef>
#include <span>
#include <string_view>

namespace gs::app {

/// One kind of content that opens as a world. The table of them is the only place that knows them.
struct ContentType {
  std::string_view name;        // "VRML97"
  std::string_view mime;        // "model/vrml"
  std::string_view extensions;  // lower case, each with its point, a blank behind each: ".wrl .vrml "
  bool (*sniff)(std::span<const std::byte> bytes);  // by the first bytes; null: only the name tells
  /// Bytes to nodes; null for VRML97 itself, which is read piece by piece as it is unpacked.
  void (*import)(std::span<const std::byte> bytes, vrml::SceneGraph& scene, vrml::Diagnostics& diagnostics,
                 const ReadFile& read_file);
};

[[nodiscard]] std::span<const ContentType> content_types();

/// The type of a file: by its first bytes, else by its name (a `.gz` at its end does not count), else
/// VRML97, whose parser says best what is wrong with anything else.
[[nodiscard]] const ContentType& content_type_of(std::string_view path, std::span<const std::byte> bytes);

}  // namespace gs::app
