#include "app/formats/mesh_import.h"

#include "app/formats/common/scene_builder.h"
#include "base/gzip.h"

#include <utility>

namespace gs::app {
namespace {


}  // namespace

std::unique_ptr<vrml::SceneGraph> import_mesh(const ContentType& type, const std::string& path,
                                              std::span<const std::byte> bytes, Diagnostics& diagnostics,
                                              const ReadFile& read_file, const WorldBudget& budget) {
  if (bytes.empty()) {
    diagnostics.add({Severity::error, path, {}, "the file is empty; expected " + std::string(type.name)});
    return nullptr;
  }
  const std::size_t errors = diagnostics.errors();
  UnpackedBytes unpacked;
  if (is_gzip(bytes)) {
    unpacked = unpack_gzip(bytes, budget, Resource::files);
    if (unpacked.problem) diagnostics.add({Severity::error, path, {}, *unpacked.problem});
    if (!unpacked.bytes.empty()) bytes = unpacked.bytes.span();
  }
  auto scene = std::make_unique<vrml::SceneGraph>(path, budget);
  bool whole = true;
  try {
    type.import(bytes, *scene, diagnostics, read_file);
  } catch (const OutOfBudget&) {
    whole = budget->stopped();
  }
  if (!whole || scene->exhausted())
    diagnostics.add({Severity::error, path, {}, budget->refusal(Resource::nodes) + "; the rest is left out"});
  if (!scene->roots().empty()) return scene;
  if (diagnostics.errors() == errors)
    diagnostics.add({Severity::error, path, {}, "has nothing to show; read as " + std::string(type.name)});
  return nullptr;
}

}  // namespace gs::app
