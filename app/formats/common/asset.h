#pragma once

#include "app/base/read_file.h"
#include "app/base/read_files.h"
#include "app/formats/common/mesh_asset.h"
#include "app/formats/common/voxel_component.h"
#include "base/budget.h"
#include "base/diagnostic.h"
#include "qnv/base/geometry.h"
#include "qnv/sampling/volume/volume.h"

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <variant>

namespace gs::vrml {
class SceneGraph;
}

namespace gs::app {

struct ContentType;

/// File to import, with its context.
struct ImportSource {
  std::span<const std::byte> bytes;  // unpacked
  const std::string& path;           // name in diagnostics; a volume is opened by it
  const ReadFile& read_file;         // reads files that this one refers to; may be null
  const WorldBudget& budget;
  Diagnostics& diagnostics;
  std::string name = {};  // original file name of a volume; empty means that of `path`
  VoxelComponent component{};
  bool for_x3d = false;  // the scene becomes part of an X3D world
  bool local = false;    // a file of this machine
  ReadFiles read_files = {};     // reads files of a container; may be null
  ListFolder list_folder = {};  // lists folders of a container; may be null
  NeedBytes need = {};          // receives parts of the file from a server; null if the file is complete
};

/// Nodes of a file that has its own, such as transformations (glTF). Never null.
struct SceneAsset {
  std::unique_ptr<vrml::SceneGraph> scene;

  explicit SceneAsset(std::unique_ptr<vrml::SceneGraph> given);
  SceneAsset(SceneAsset&&) noexcept;
  SceneAsset& operator=(SceneAsset&&) noexcept;
  ~SceneAsset();
};

/// Content of a file: a scene (glTF), a mesh as plain values, vectors (splats or points), or a volume that is read
/// slice by slice. std::monostate means that there is nothing; the diagnostics give the reason.
using Asset = std::variant<std::monostate, SceneAsset, MeshAsset, qnv::Splats, qnv::Gaussians, qnv::VolumeSource>;

/// Reads a mesh with the importer of its format; for the rows of the table of content types.
template <auto import>
[[nodiscard]] Asset read_mesh(const ImportSource& source) {
  MeshBuilder builder(source.path, source.budget, source.diagnostics);
  builder.choose(source.component);
  try {
    if constexpr (requires { import(source.bytes, builder, source.read_file); })
      import(source.bytes, builder, source.read_file);
    else
      import(source.bytes, builder);
  } catch (const OutOfBudget&) {
    builder.cut_short();
  }
  return builder.take();
}

/// Imports a file, gzip-compressed or not, of a type with `read`. Returns std::monostate if there is nothing to show.
/// Safe for untrusted input; memory is charged to the budget. Runs on any thread.
/// `read` imports the unpacked bytes; by default type.read does, in this process.
[[nodiscard]] Asset read_asset(const ContentType& type, ImportSource source,
                               Asset (*read)(const ContentType& type, const ImportSource& source) = nullptr);

/// Makes the nodes of a mesh: one Shape per part. Moves the arrays, so that they need no further memory.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> scene_of(MeshAsset mesh, const std::string& path,
                                                         const WorldBudget& budget, Diagnostics& diagnostics);

/// Imports a file as a scene. Returns null if there is nothing to show; the diagnostics give the reason.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> import_scene(const ContentType& type, const ImportSource& source,
                                                             Asset (*read)(const ContentType& type,
                                                                           const ImportSource& source) = nullptr);

}  // namespace gs::app
