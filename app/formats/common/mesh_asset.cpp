#include "app/formats/common/mesh_asset.h"

#include "app/formats/common/geometry_check.h"

#include <algorithm>

namespace gs::app {
namespace {

std::uint64_t bytes_of(const Geometry& geometry) {
  const auto bytes = [](const auto& array) { return array.size() * sizeof(*array.data()); };
  return bytes(geometry.positions) + bytes(geometry.normals) + bytes(geometry.colors) +
         bytes(geometry.texture_coordinates) + bytes(geometry.coord_index) + bytes(geometry.normal_index) +
         bytes(geometry.texture_index);
}

}  // namespace

Look glowing(Look look) {
  look.emissive = look.diffuse;
  look.diffuse = look.specular = {};
  look.ambient_intensity = 0;
  return look;
}

bool MeshAsset::has_textures() const {
  return std::any_of(looks.begin(), looks.end(), [](const NamedLook& one) { return !one.look.texture_url.empty(); });
}

bool MeshBuilder::add(Geometry geometry, Look look, std::string_view name) {
  if (!keep_drawable(geometry, *this)) return false;
  add_part(std::move(geometry), add_look(std::move(look), {}), name);
  return true;
}

std::size_t MeshBuilder::add_look(Look look, std::string_view name) {
  asset_.looks.push_back({std::move(look), std::string(name)});
  return asset_.looks.size() - 1;
}

void MeshBuilder::add_part(Geometry geometry, std::size_t look, std::string_view name) {
  asset_.parts.push_back({std::move(geometry), look, std::string(name)});
}

void MeshBuilder::cut_short() {
  if (!budget()->stopped()) {
    asset_.cut_short = true;
    fail(budget()->refusal(Resource::nodes) + "; skipped the rest");
  }
  // The arrays of unfinished parts are gone.
  std::uint64_t kept = 0;
  for (const MeshPart& part : asset_.parts) kept += bytes_of(part.geometry);
  memory().shrink_to(kept);
}

MeshAsset MeshBuilder::take() {
  asset_.memory = std::move(memory());
  return std::move(asset_);
}

}  // namespace gs::app
