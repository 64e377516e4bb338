#pragma once

#include "app/formats/common/asset.h"
#include "app/formats/common/upright.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace gs::app {

/// Content of a file, which decides how it is read.
enum class ContentClass : std::uint8_t {
  vrml,    // read piece by piece, as it is unpacked
  mesh,    // imported at once as a mesh or a scene
  stream,  // a QNV stream, decoded piece by piece
  cloud,   // vectors of other programs, imported as a cloud
  volume,  // opened by its path, slice by slice; its strongest gradients become a cloud
};

/// One kind of content that opens as a world. The table of them is the only place that knows them.
struct ContentType {
  std::string_view name;        // "VRML97"
  std::string_view mime;        // "model/vrml"
  std::string_view extensions;  // lower case, each with its point, a blank behind each: ".wrl .vrml "
  bool (*sniff)(std::span<const std::byte> bytes) = nullptr;  // by the first bytes; null if only the name decides
  ContentClass content = ContentClass::vrml;
  /// Reads a whole file; null for VRML97 and QNV streams, which are read piece by piece.
  Asset (*read)(const ImportSource& source) = nullptr;
  UpRule up = UpRule::y;        // up axis, unless the file names one
  bool unpacks_itself = false;  // gzip is part of the format
  bool has_nodes = false;       // mesh: `read` returns a scene, with its own nodes
  bool in_order = false;        // mesh: may be read triangle by triangle (open_mesh_stream)
  std::string_view mark = {};   // bytes that each file begins with; empty if the type has no such mark

  /// True for types that become vectors in the place of nodes.
  [[nodiscard]] bool is_cloud() const {
    return content == ContentClass::stream || content == ContentClass::cloud || content == ContentClass::volume;
  }
};

}  // namespace gs::app
