#include "app/formats/confined/asset_transfer.h"

#include "app/formats/common/geometry_check.h"
#include "app/formats/common/import_limits.h"
#include "app/formats/common/transfer.h"
#include "app/formats/confined/scene_transfer.h"
#include "vrml/scene/scene_graph.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace gs::app {
namespace {

enum class AssetTag : std::uint8_t { none, mesh, splats, gaussians, scene };

// ---- Meshes

void write(TransferWriter& to, const MeshAsset& mesh) {
  to.value<std::uint64_t>(mesh.looks.size());
  for (const MeshAsset::NamedLook& one : mesh.looks) {
    const Look& look = one.look;
    to.value(look.diffuse);
    to.value(look.specular);
    to.value(look.emissive);
    to.value(std::array{look.ambient_intensity, look.shininess, look.transparency});
    to.value(std::array<std::uint8_t, 3>{look.lit, look.repeat_s, look.repeat_t});
    to.text(look.texture_url.view());
    to.text(one.name);
  }
  to.value<std::uint64_t>(mesh.parts.size());
  for (const MeshPart& part : mesh.parts) {
    const Geometry& geometry = part.geometry;
    to.value(geometry.kind);
    to.list(geometry.positions);
    to.list(geometry.normals);
    to.list(geometry.colors);
    to.list(geometry.texture_coordinates);
    to.list(geometry.coord_index);
    to.list(geometry.normal_index);
    to.list(geometry.texture_index);
    to.value(std::array<std::uint8_t, 3>{geometry.color_per_vertex, geometry.solid, geometry.convex});
    to.value(geometry.crease_angle);
    to.value<std::uint64_t>(part.look);
    to.text(part.name);
  }
  to.value<std::uint8_t>(mesh.color_key.has_value());
  if (mesh.color_key) {
    to.text(mesh.color_key->title);
    to.value(std::array{mesh.color_key->low, mesh.color_key->high});
    to.list(mesh.color_key->colors);
  }
  to.list(mesh.steps ? mesh.steps->times : std::vector<double>());
  to.value<std::uint64_t>(mesh.steps ? mesh.steps->shown : 0);
  to.value<std::uint8_t>(mesh.cut_short);
}

float share_of(float value) { return value >= 0 && value <= 1 ? value : throw Impossible(); }

vrml::Color checked(const vrml::Color& color) { return {share_of(color.r), share_of(color.g), share_of(color.b)}; }

MeshAsset::NamedLook read_look(TransferReader& from) {
  MeshAsset::NamedLook made;
  Look& look = made.look;
  look.diffuse = checked(from.value<vrml::Color>());
  look.specular = checked(from.value<vrml::Color>());
  look.emissive = checked(from.value<vrml::Color>());
  const auto numbers = from.value<std::array<float, 3>>();
  look.ambient_intensity = share_of(numbers[0]);
  look.shininess = share_of(numbers[1]);
  look.transparency = share_of(numbers[2]);
  const auto truths = from.value<std::array<std::uint8_t, 3>>();
  look.lit = truths[0] != 0;
  look.repeat_s = truths[1] != 0;
  look.repeat_t = truths[2] != 0;
  look.texture_url = from.text();
  made.name = from.text();
  return made;
}

MeshPart read_part(TransferReader& from, std::size_t looks) {
  MeshPart part;
  Geometry& geometry = part.geometry;
  const auto kind = from.value<std::uint8_t>();
  if (kind > static_cast<std::uint8_t>(Geometry::Kind::points)) throw Impossible();
  geometry.kind = static_cast<Geometry::Kind>(kind);
  geometry.positions = from.array<vrml::SFVec3f>();
  geometry.normals = from.array<vrml::SFVec3f>();
  geometry.colors = from.array<vrml::Color>();
  geometry.texture_coordinates = from.array<vrml::SFVec2f>();
  geometry.coord_index = from.array<std::int32_t>();
  geometry.normal_index = from.array<std::int32_t>();
  geometry.texture_index = from.array<std::int32_t>();
  const auto truths = from.value<std::array<std::uint8_t, 3>>();
  geometry.color_per_vertex = truths[0] != 0;
  geometry.solid = truths[1] != 0;
  geometry.convex = truths[2] != 0;
  geometry.crease_angle = from.value<float>();
  if (!(geometry.crease_angle >= 0 && geometry.crease_angle <= 100)) throw Impossible();
  const auto look = from.value<std::uint64_t>();
  if (look >= looks) throw Impossible();
  part.look = static_cast<std::size_t>(look);
  part.name = from.text();
  return part;
}

std::uint64_t bytes_in(const Geometry& geometry) {
  return geometry.positions.size() * sizeof(vrml::SFVec3f) + geometry.normals.size() * sizeof(vrml::SFVec3f) +
         geometry.colors.size() * sizeof(vrml::Color) + geometry.texture_coordinates.size() * sizeof(vrml::SFVec2f) +
         (geometry.coord_index.size() + geometry.normal_index.size() + geometry.texture_index.size()) *
             sizeof(std::int32_t);
}

MeshAsset read_mesh_asset(TransferReader& from, const ImportSource& source) {
  constexpr std::size_t kLeastLook = 40, kLeastPart = 60;  // bytes
  MeshAsset mesh;
  mesh.memory = Share(source.budget, Resource::nodes);
  for (std::size_t left = from.count(kLeastLook); left > 0; --left) mesh.looks.push_back(read_look(from));
  for (std::size_t left = from.count(kLeastPart); left > 0; --left) {
    MeshPart part = read_part(from, mesh.looks.size());
    if (!mesh.memory.grow(bytes_in(part.geometry))) throw OutOfBudget();
    // The child has reported what it removed. Nothing is left to remove, unless it lies.
    Diagnostics ignored;
    ImportContext context(source.path, source.budget, ignored);
    if (keep_drawable(part.geometry, context)) mesh.parts.push_back(std::move(part));
  }
  if (from.truth()) {
    ColorKey key;
    key.title = from.text();
    const auto ends = from.value<std::array<double, 2>>();
    key.low = ends[0];
    key.high = ends[1];
    key.colors = from.list<vrml::Color>();
    if (!std::isfinite(key.low) || !std::isfinite(key.high) || key.colors.size() < 2) throw Impossible();
    for (vrml::Color& color : key.colors) color = checked(color);
    mesh.color_key = std::move(key);
  }
  TimeSteps steps{from.list<double>(), 0};
  steps.shown = static_cast<std::size_t>(from.value<std::uint64_t>());
  if (!steps.times.empty()) {
    if (!is_valid(steps)) throw Impossible();
    mesh.steps = std::move(steps);
  }
  mesh.cut_short = from.truth();
  return mesh;
}

// ---- Splats

void write(TransferWriter& to, const qnv::Description& description) {
  to.value<std::uint8_t>(description.two_sided);
  to.value(description.origin);
  to.value(description.box.lower);
  to.value(description.box.upper);
  to.value(description.total);
  to.value(description.spacing);
  to.value(std::array{description.value_range.first, description.value_range.second});
  to.list(description.transfer);
  to.value<std::uint64_t>(description.metadata.size());
  for (const auto& [key, value] : description.metadata) {
    to.text(key);
    to.text(value);
  }
}

void write(TransferWriter& to, const qnv::Splats& splats) {
  write(to, splats.description);
  to.value(splats.color);
  to.list(splats.positions);
  to.list(splats.normals);
  to.list(splats.weights);
  to.list(splats.colors);
  to.list(splats.cells);
}

void write(TransferWriter& to, const qnv::Gaussians& splats) {
  write(to, static_cast<const qnv::Splats&>(splats));
  to.list(splats.scales);
  to.list(splats.rotations);
  to.list(splats.opacities);
  to.list(splats.bases);
  to.value<std::uint8_t>(static_cast<std::uint8_t>(splats.degree));
  to.list(splats.harmonics);
  to.value<std::uint8_t>(splats.antialiased);
}

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool is_finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

qnv::Description read_description(TransferReader& from) {
  qnv::Description description;
  description.two_sided = from.truth();
  description.origin = from.value<glm::dvec3>();
  description.box.lower = from.value<glm::vec3>();
  description.box.upper = from.value<glm::vec3>();
  description.total = from.value<double>();
  description.spacing = from.value<float>();
  const auto range = from.value<std::array<float, 2>>();
  description.value_range = {range[0], range[1]};
  description.transfer = from.list<qnv::TransferPoint>();
  require_possible(
      is_finite(description.origin) &&
      (description.box.empty() || (is_finite(description.box.lower) && is_finite(description.box.upper))) &&
      description.total >= 0 && std::isfinite(description.total) && description.spacing >= 0 &&
      std::isfinite(description.spacing) && std::isfinite(range[0]) && std::isfinite(range[1]));
  for (const qnv::TransferPoint& point : description.transfer)
    require_possible(point.value >= 0 && point.value <= 1 && point.opacity >= 0 && point.opacity <= 1);
  constexpr std::size_t kLeastPair = 16;  // bytes
  for (std::size_t left = from.count(kLeastPair); left > 0; --left) {
    std::string key = from.text();
    description.metadata.emplace_back(std::move(key), from.text());
  }
  return description;
}

void read_splats(TransferReader& from, qnv::Splats& splats) {
  splats.description = read_description(from);
  splats.color = from.value<qnv::Rgb8>();
  splats.positions = from.list<glm::vec3>();
  splats.normals = from.list<glm::vec3>();
  splats.weights = from.list<float>();
  splats.colors = from.list<qnv::Rgb8>();
  splats.cells = from.list<qnv::Cell>();
  const std::size_t count = splats.size();
  const auto fits = [count](std::size_t size) { return size == 0 || size == count; };
  require_possible(splats.normals.size() == count && splats.weights.size() == count && fits(splats.colors.size()) &&
                   fits(splats.cells.size()));
  const Box& box = splats.description.box;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 p = splats.positions[i], n = splats.normals[i];
    require_possible(p.x >= box.lower.x && p.x <= box.upper.x && p.y >= box.lower.y && p.y <= box.upper.y &&
                     p.z >= box.lower.z && p.z <= box.upper.z);
    require_possible(std::abs(glm::dot(n, n) - 1) < 0.01f && splats.weights[i] > 0 && std::isfinite(splats.weights[i]));
  }
  for (const qnv::Cell& cell : splats.cells) require_possible(cell.edge >= 0 && std::isfinite(cell.edge + cell.offset));
}

void read_gaussians(TransferReader& from, qnv::Gaussians& splats) {
  read_splats(from, splats);
  splats.scales = from.list<glm::vec3>();
  splats.rotations = from.list<glm::vec4>();
  splats.opacities = from.list<float>();
  splats.bases = from.list<glm::vec3>();
  splats.degree = from.value<std::uint8_t>();
  require_possible(splats.degree <= qnv::Gaussians::kMaxDegree);
  splats.harmonics = from.list<glm::vec3>();
  splats.antialiased = from.truth();
  const std::size_t count = splats.size();
  require_possible(splats.scales.size() == count && splats.rotations.size() == count &&
                   splats.opacities.size() == count && splats.bases.size() == count &&
                   splats.harmonics.size() == count * qnv::harmonic_count(splats.degree));
  for (std::size_t i = 0; i < count; ++i) {
    const glm::vec3 scale = splats.scales[i];
    const glm::vec4 rotation = splats.rotations[i];
    require_possible(scale.x >= 0 && scale.y >= 0 && scale.z >= 0 && is_finite(scale));
    require_possible(std::abs(glm::dot(rotation, rotation) - 1) < 0.01f);
    require_possible(splats.opacities[i] >= 0 && splats.opacities[i] <= 1 && is_finite(splats.bases[i]));
  }
  require_possible(std::ranges::all_of(splats.harmonics, [](const glm::vec3& one) { return is_finite(one); }));
}

// ---- Assets

void read_diagnostics(TransferReader& from, const ImportSource& source) {
  constexpr std::size_t kLeastDiagnostic = 17;  // bytes
  for (std::size_t left = from.count(kLeastDiagnostic); left > 0; --left) {
    Diagnostic one;
    const auto severity = from.value<std::uint8_t>();
    require_possible(severity <= static_cast<std::uint8_t>(Severity::error));
    one.severity = static_cast<Severity>(severity);
    one.location.line = from.value<std::uint32_t>();
    one.location.column = from.value<std::uint32_t>();
    one.file = source.path;
    one.message = from.text();
    source.diagnostics.add(std::move(one));
  }
}

Asset read_content(TransferReader& from, const ImportSource& source) {
  const auto tag = from.value<std::uint8_t>();
  require_possible(tag <= static_cast<std::uint8_t>(AssetTag::scene));
  switch (static_cast<AssetTag>(tag)) {
    case AssetTag::none:
      return {};
    case AssetTag::mesh:
      return read_mesh_asset(from, source);
    case AssetTag::scene:
      return SceneAsset(read_scene(from, source));
    case AssetTag::splats: {
      qnv::Splats splats;
      read_splats(from, splats);
      return splats;
    }
    case AssetTag::gaussians: {
      qnv::Gaussians splats;
      read_gaussians(from, splats);
      return splats;
    }
  }
  return {};
}

}  // namespace

std::vector<std::byte> transfer_bytes(const ImportRequest& request) {
  TransferWriter to;
  to.text(request.type);
  to.text(request.path);
  to.text(request.name);
  to.value<std::uint8_t>(request.reads_files);
  to.value<std::uint8_t>(request.for_x3d);
  write_component(to, request.component);
  to.value(request.left);
  return to.take();
}

std::optional<ImportRequest> import_request_of(std::span<const std::byte> bytes) try {
  TransferReader from(bytes);
  ImportRequest request;
  request.type = from.text();
  request.path = from.text();
  request.name = from.text();
  request.reads_files = from.truth();
  request.for_x3d = from.truth();
  request.component = read_component(from);
  request.left = from.value<BudgetLeft>();
  return request;
} catch (const Impossible&) {
  return std::nullopt;
}

bool can_transfer(const Asset& asset) {
  if (const auto* const scene = std::get_if<SceneAsset>(&asset)) return can_transfer(*scene->scene);
  return std::holds_alternative<std::monostate>(asset) || std::holds_alternative<MeshAsset>(asset) ||
         std::holds_alternative<qnv::Splats>(asset) || std::holds_alternative<qnv::Gaussians>(asset);
}

std::vector<std::byte> transfer_bytes(const Asset& asset, const Diagnostics& diagnostics, const DatasetList& datasets) {
  TransferWriter to;
  to.value<std::uint64_t>(diagnostics.entries().size());
  for (const Diagnostic& one : diagnostics.entries()) {
    to.value(one.severity);
    to.value(one.location.line);
    to.value(one.location.column);
    to.text(one.message);
  }
  if (const auto* const mesh = std::get_if<MeshAsset>(&asset)) {
    to.value(AssetTag::mesh);
    write(to, *mesh);
  } else if (const auto* const scene = std::get_if<SceneAsset>(&asset)) {
    to.value(AssetTag::scene);
    write_scene(to, *scene->scene);
  } else if (const auto* const gaussians = std::get_if<qnv::Gaussians>(&asset)) {
    to.value(AssetTag::gaussians);
    write(to, *gaussians);
  } else if (const auto* const splats = std::get_if<qnv::Splats>(&asset)) {
    to.value(AssetTag::splats);
    write(to, *splats);
  } else {
    to.value(AssetTag::none);
  }
  if (!datasets.entries.empty()) write_datasets(to, datasets);
  return to.take();
}

Asset asset_of(std::span<const std::byte> bytes, const ImportSource& source) try {
  TransferReader from(bytes);
  read_diagnostics(from, source);
  Asset asset = read_content(from, source);
  DatasetList datasets = from.empty() ? DatasetList() : read_datasets(from);
  if (source.component.found) *source.component.found = std::move(datasets);
  require_possible(from.empty());
  return asset;
} catch (const Impossible&) {
  source.diagnostics.add({Severity::error, source.path, {}, "the process that read it gave an impossible result"});
  return {};
} catch (const OutOfBudget&) {
  source.diagnostics.add({Severity::error, source.path, {}, source.budget->refusal(Resource::nodes)});
  return {};
}

}  // namespace gs::app
