// Fuzzes the results of confined children, as this process reads them.
#include "app/formats/confined/asset_transfer.h"
#include "app/formats/volume/confined/volume_transfer.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "tests/fuzz/app_targets.h"
#include "vrml/scene/scene_graph.h"

#include <string>
#include <variant>

using namespace gs::app;

namespace gs::fuzz {

bool run_asset_transfer(std::span<const std::byte> bytes) {
  const std::string path = "file";
  Diagnostics diagnostics;
  const WorldBudget budget = own_budget();
  const Asset asset = asset_of(bytes, {bytes, path, {}, budget, diagnostics});
  if (const auto* const mesh = std::get_if<MeshAsset>(&asset))
    for (const MeshPart& part : mesh->parts) {
      require(part.look < mesh->looks.size());
      for (const std::int32_t index : part.geometry.coord_index)
        require(index >= -1 && index < static_cast<std::int32_t>(part.geometry.positions.size()));
    }
  if (const auto* const scene = std::get_if<SceneAsset>(&asset))
    for (const vrml::NodeId root : scene->scene->roots()) require(scene->scene->contains(root));
  if (!std::holds_alternative<std::monostate>(asset)) {
    // The same asset can be written, and read again.
    require(can_transfer(asset));
    const auto again = transfer_bytes(asset, {});
    Diagnostics none;
    require(!std::holds_alternative<std::monostate>(asset_of(again, {again, path, {}, budget, none})));
  }
  return !std::holds_alternative<std::monostate>(asset);
}

bool run_volume_transfer(std::span<const std::byte> bytes) {
  (void)volume_request_of(bytes);
  const auto reply = volume_reply_of(bytes, [](std::size_t, const qnv::VolumeLayout&) { return nullptr; });
  const auto* const volume = reply ? std::get_if<qnv::VolumeSource>(&reply->volume) : nullptr;
  if (!volume) return false;
  for (const qnv::VolumeSource* const source : numbered_sources(*volume)) {
    require(!qnv::check(source->layout));
    require(qnv::voxel_count(source->layout) <= qnv::voxel_count(volume->layout));
  }
  require(volume->times.size() == volume->steps.size());
  return true;
}

}  // namespace gs::fuzz
