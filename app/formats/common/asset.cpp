#include "app/formats/common/asset.h"

#include "app/formats/common/content_type.h"
#include "app/formats/common/scene_builder.h"
#include "base/gzip.h"

#include <utility>

namespace gs::app {

SceneAsset::SceneAsset(std::unique_ptr<vrml::SceneGraph> given) : scene(std::move(given)) {}
SceneAsset::SceneAsset(SceneAsset&&) noexcept = default;
SceneAsset& SceneAsset::operator=(SceneAsset&&) noexcept = default;
SceneAsset::~SceneAsset() = default;

Asset read_asset(const ContentType& type, ImportSource source,
                 Asset (*read)(const ContentType& type, const ImportSource& source)) {
  Diagnostics& diagnostics = source.diagnostics;
  if (!type.remedy.empty() && !source.bytes.empty()) {
    diagnostics.add({Severity::error, source.path, {}, type.refusal()});
    return {};
  }
  if (source.bytes.empty()) {
    diagnostics.add({Severity::error, source.path, {}, "the file is empty; expected " + std::string(type.name)});
    return {};
  }
  const std::size_t errors = diagnostics.errors();
  UnpackedBytes unpacked;
  if (is_gzip(source.bytes)) {
    unpacked = unpack_gzip(source.bytes, source.budget, Resource::files);
    if (unpacked.problem) diagnostics.add({Severity::error, source.path, {}, *unpacked.problem});
    if (!unpacked.bytes.empty()) source.bytes = unpacked.bytes.span();
  }
  Asset asset = read ? read(type, source) : type.read(source);
  const auto* scene = std::get_if<SceneAsset>(&asset);
  const auto* mesh = std::get_if<MeshAsset>(&asset);
  if (!(scene && scene->scene->roots().empty()) && !(mesh && mesh->empty())) return asset;
  if (diagnostics.errors() == errors)
    diagnostics.add({Severity::error, source.path, {}, "has nothing to show; read as " + std::string(type.name)});
  return {};
}

std::unique_ptr<vrml::SceneGraph> scene_of(MeshAsset mesh, const std::string& path, const WorldBudget& budget,
                                           Diagnostics& diagnostics) {
  auto scene = std::make_unique<vrml::SceneGraph>(path, budget);
  // From here on, the scene holds the memory of the arrays.
  const std::uint64_t bytes = mesh.memory.amount();
  mesh.memory.shrink_to(0);
  (void)scene->memory().charge(static_cast<std::size_t>(bytes));
  SceneBuilder builder(*scene, diagnostics);
  std::vector<vrml::NodeId> appearances(mesh.looks.size());
  std::vector<bool> made(mesh.looks.size());
  for (MeshPart& part : mesh.parts) {
    const vrml::NodeId geometry = builder.checked_geometry(std::move(part.geometry));
    if (!geometry) continue;
    if (!made[part.look]) {
      made[part.look] = true;
      appearances[part.look] = builder.appearance(mesh.looks[part.look].look);
      builder.name(appearances[part.look], mesh.looks[part.look].name);
    }
    const vrml::NodeId shape = builder.shape(geometry, appearances[part.look]);
    builder.name(shape, part.name);
    builder.add_root(shape);
  }
  if (mesh.color_key) add_color_key(builder, *mesh.color_key);
  if (mesh.steps) add_time_steps(builder, *mesh.steps);
  if (scene->memory().exhausted() && !mesh.cut_short)
    diagnostics.add({Severity::error, path, {}, budget->refusal(Resource::nodes) + "; skipped the rest"});
  return scene;
}

std::unique_ptr<vrml::SceneGraph> import_scene(const ContentType& type, const ImportSource& source,
                                               Asset (*read)(const ContentType& type, const ImportSource& source)) {
  Asset asset = read_asset(type, source, read);
  if (auto* scene = std::get_if<SceneAsset>(&asset)) return std::move(scene->scene);
  auto* mesh = std::get_if<MeshAsset>(&asset);
  if (!mesh) return nullptr;
  auto scene = scene_of(std::move(*mesh), source.path, source.budget, source.diagnostics);
  return scene->roots().empty() ? nullptr : std::move(scene);
}

}  // namespace gs::app
