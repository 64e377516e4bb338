#pragma once

#include "app/base/read_file.h"
#include "app/formats/common/upright.h"
#include "app/formats/splats/splats.h"
#include "base/budget.h"
#include "base/diagnostic.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Content of a file, which decides how it is read.
enum class ContentClass : std::uint8_t {
  vrml,    // read piece by piece, as it is unpacked
  mesh,    // imported as nodes
  stream,  // a QNV stream, decoded piece by piece
  cloud,   // vectors of other programs, imported as a cloud
  volume,  // opened by its path, slice by slice; its strongest gradients become a cloud
};

/// One kind of content that opens as a world. The table of them is the only place that knows them.
struct ContentType {
  std::string_view name;        // "VRML97"
  std::string_view mime;        // "model/vrml"
  std::string_view extensions;  // lower case, each with its point, a blank behind each: ".wrl .vrml "
  bool (*sniff)(std::span<const std::byte> bytes);  // by the first bytes; null if only the name decides
  ContentClass content = ContentClass::vrml;
  /// ContentClass::mesh: bytes to nodes.
  void (*import)(std::span<const std::byte> bytes, vrml::SceneGraph& scene, Diagnostics& diagnostics,
                 const ReadFile& read_file) = nullptr;
  /// ContentClass::cloud: bytes to vectors.
  ImportedCloud (*import_cloud)(std::span<const std::byte> bytes, const WorldBudget& budget) = nullptr;
  bool unpacks_itself = false;  // gzip is part of the format
  UpRule up = UpRule::y;        // up axis, unless the file names one
  bool in_order = false;        // mesh: may be read triangle by triangle (open_mesh_stream)
  std::string_view mark = {};   // bytes that each file begins with; empty if the type has no such mark

  /// True for types that become vectors in the place of nodes.
  [[nodiscard]] bool is_cloud() const {
    return content == ContentClass::stream || content == ContentClass::cloud || content == ContentClass::volume;
  }
};

[[nodiscard]] std::span<const ContentType> content_types();

/// Returns the type of a file by its first bytes (see `first_bytes`), else by its name without a final `.gz`, else
/// VRML97, which reports errors best.
[[nodiscard]] const ContentType& content_type_of(std::string_view path, std::span<const std::byte> bytes);

/// Rejects a file by its first bytes (at most 8 KiB) if its name promises a type with a mark that they lack. Returns
/// nullopt if reading it makes sense. A large file can be refused before it is mapped.
[[nodiscard]] std::optional<std::string> refuse_first_bytes(std::string_view path, std::span<const std::byte> first);

/// Returns the type that the first bytes identify, or null if there is none.
[[nodiscard]] const ContentType* content_type_by_mark(std::span<const std::byte> bytes);

/// The first bytes of a file, behind its gzip wrapper if it has one: enough to tell its type.
[[nodiscard]] std::vector<std::byte> first_bytes(std::span<const std::byte> bytes);

/// "VRML97 (.wrl .wrz .vrml), PLY (.ply), ...": for help.
[[nodiscard]] std::string content_type_list();

/// Reports whether bytes begin like a QNV stream with the outlines payload, which has polygons instead of vectors.
[[nodiscard]] bool is_outline_stream(std::span<const std::byte> bytes);

}  // namespace gs::app
