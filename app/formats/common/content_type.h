#pragma once

#include "app/formats/common/asset.h"
#include "app/formats/common/upright.h"

#include "vrml/scene/x3d/language.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

struct SplatRows;
using OpenedSplatRows = std::variant<SplatRows, std::string>;

/// Class of a file's content. Decides how the file is read.
enum class ContentClass : std::uint8_t {
  vrml,    // scene, read while it is received and decompressed
  mesh,    // imported at once as a mesh or a scene
  stream,  // QNV stream, decoded while it is received
  splats,  // vectors or splats of other programs, imported as vectors
  volume,  // volume, read from its path slice by slice; its strongest gradients become vectors
};

/// File type that opens as a world. Only the table of types distinguishes the types.
struct ContentType {
  std::string_view name;        // "VRML97"
  std::string_view mime;        // "model/vrml"
  std::string_view extensions;  // lower case, each with its point, a blank behind each: ".wrl .vrml "
  bool (*sniff)(std::span<const std::byte> bytes) = nullptr;  // tests the first bytes; null if only the name decides
  ContentClass content = ContentClass::vrml;
  /// Reads a whole file; null for VRML97 and QNV streams, which are read piece by piece.
  Asset (*read)(const ImportSource& source) = nullptr;
  UpRule up = UpRule::y;                          // rule for the up axis, unless the file defines it
  bool unpacks_itself = false;                    // the format contains gzip compression; the importer decompresses
  bool has_nodes = false;                         // mesh: `read` returns a scene, with its own nodes
  bool in_order = false;                          // mesh: may be read triangle by triangle (open_mesh_stream)
  std::string_view mark = {};                     // first bytes of each file of this type; empty if they vary
  std::string_view remedy = {};                   // advice to users, if the type is recognised but not read; else empty
  vrml::Grammar grammar = vrml::Grammar::vrml97;  // ContentClass::vrml only: reader of the text
  /// Volume: returns true if a whole file of this type is a mesh instead, with the type `mesh_type`. Null if none is.
  bool (*holds_mesh)(const ImportSource& source) = nullptr;
  const ContentType* mesh_type = nullptr;
  bool belongs_to_others = false;  // other viewers own such files, so that the desktop does not offer this program
  /// Splats: opens a file that is not compressed, to read it in ranges. Null if this type is only read whole.
  OpenedSplatRows (*open_rows)(std::span<const std::byte> bytes, const WorldBudget& budget) = nullptr;

  /// Returns the error for a file of a type with a `remedy`: "STEP cannot be read; open it in ...".
  [[nodiscard]] std::string refusal() const { return std::string(name) + " cannot be read; " + std::string(remedy); }
  /// Returns true if files of this type become vectors instead of nodes.
  [[nodiscard]] bool is_geometry() const {
    return content == ContentClass::stream || content == ContentClass::splats || content == ContentClass::volume;
  }
};

/// Properties that few mesh formats have.
struct MeshTraits {
  UpRule up = UpRule::y;
  bool in_order = false;
  std::string_view mark = {};
};

/// Returns the row of a mesh format.
[[nodiscard]] constexpr ContentType mesh_type(std::string_view name, std::string_view mime, std::string_view extensions,
                                              bool (*sniff)(std::span<const std::byte> bytes),
                                              Asset (*read)(const ImportSource& source), MeshTraits traits = {}) {
  return {name,      mime,  extensions, sniff,           ContentClass::mesh, read,
          traits.up, false, false,      traits.in_order, traits.mark};
}

}  // namespace gs::app
