#include "app/view/derived/volume_derivations.h"

#include "app/formats/qnv/geometry_reader.h"
#include "app/view/values/color_maps.h"
#include "app/view/values/fine_values.h"
#include "app/view/derived/surface_parts.h"
#include "qnv/sampling/volume/gradients.h"
#include "qnv/sampling/volume/isosurface.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

namespace gs::app {
namespace {

constexpr std::size_t kMostVectors = std::size_t{1} << 24;

/// Builder of a mesh from the triangles of an isosurface. Corners at the same position share a vertex.
class SurfaceJoiner {
 public:
  SurfaceJoiner(const WorldBudget& budget, std::size_t most_triangles)
      : share_(budget, Resource::meshes), most_(most_triangles) {}

  /// Adds triangles. Returns false if there are too many, or if the budget is exceeded.
  bool add(std::span<const qnv::Triangle> triangles) {
    if (triangles_ + triangles.size() > most_) {
      excess_ = true;
      return false;
    }
    // Three indices, and half a vertex with its slots and the renderer's copy of all.
    constexpr std::uint64_t kTriangleBytes = 72;
    if (!share_.grow(triangles.size() * kTriangleBytes)) return false;
    for (const qnv::Triangle& triangle : triangles) {
      const auto& p = triangle.positions;
      std::array<std::uint32_t, 3> corners{};
      for (std::size_t i = 0; i < 3; ++i) corners[i] = vertex(p[i], triangle.normals[i]);
      for (std::size_t i = 0; i < 3; ++i) {
        mesh_.indices.push_back(corners[i]);
        if (mesh_.normals[corners[i]] == glm::vec3(0)) mesh_.normals.mutable_data()[corners[i]] = face_normal(p);
      }
    }
    triangles_ += triangles.size();
    return true;
  }
  /// Reports whether there were too many triangles.
  [[nodiscard]] bool excess() const { return excess_; }
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> take() {
    struct Held {
      vrml::Mesh mesh;
      Share share;
    };
    mesh_.solid = false;
    auto held = std::make_shared<Held>(Held{std::move(mesh_), std::move(share_)});
    return {held, &held->mesh};
  }

 private:
  static glm::vec3 face_normal(const std::array<glm::vec3, 3>& p) {
    const glm::vec3 cross = glm::cross(p[1] - p[0], p[2] - p[0]);
    const float length = glm::length(cross);
    return length > 0 ? cross / length : glm::vec3(0, 0, 1);
  }
  static std::size_t hash(const glm::vec3& p) {
    std::uint64_t bits = std::bit_cast<std::uint32_t>(p.x) * 0x9e3779b97f4a7c15u;
    bits = (bits ^ (bits >> 29) ^ std::bit_cast<std::uint32_t>(p.y)) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ (bits >> 32) ^ std::bit_cast<std::uint32_t>(p.z)) * 0x94d049bb133111ebu;
    return static_cast<std::size_t>(bits ^ (bits >> 31));
  }
  void grow_slots() {
    slots_.assign(std::max<std::size_t>(4096, 2 * slots_.size()), 0);
    for (std::size_t i = 0; i < mesh_.positions.size(); ++i)
      slots_[free_slot(mesh_.positions[i])] = static_cast<std::uint32_t>(i + 1);
  }
  /// Returns the slot of a position, or the free one for it.
  [[nodiscard]] std::size_t free_slot(const glm::vec3& p) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash(p) & mask;
    while (slots_[slot] != 0 && mesh_.positions[slots_[slot] - 1] != p) slot = (slot + 1) & mask;
    return slot;
  }
  std::uint32_t vertex(const glm::vec3& position, const glm::vec3& normal) {
    if (2 * mesh_.positions.size() >= slots_.size()) grow_slots();
    // -0 equals 0, but has other bits.
    const glm::vec3 p = position + glm::vec3(0);
    std::uint32_t& slot = slots_[free_slot(p)];
    if (slot == 0) {
      mesh_.positions.push_back(p);
      mesh_.normals.push_back(normal);
      mesh_.bounds.add(p);
      slot = static_cast<std::uint32_t>(mesh_.positions.size());
    }
    return slot - 1;
  }

  vrml::Mesh mesh_;
  Share share_;
  std::size_t most_, triangles_ = 0;
  std::vector<std::uint32_t> slots_;  // 1 + index of a vertex; 0 means free
  bool excess_ = false;
};

/// Returns the colours of a projection from the first to the last, as a table with opacities.
std::shared_ptr<const render::Image> color_table(const ProjectionColors& colors) {
  constexpr int kColors = 256;
  constexpr float kOpaque = 1.0f / 12;  // place of the first opaque colour
  const ColorMap* chosen = find_color_map(colors.map);
  const ColorMap& map = chosen ? *chosen : color_maps().front();
  auto table = std::make_shared<render::Image>();
  table->width = kColors;
  table->height = 1;
  table->components = 4;
  for (int i = 0; i < kColors; ++i) {
    const float place = static_cast<float>(i) / (kColors - 1);
    const glm::vec3 color = color_at(map, place) * 255.0f;
    for (int c = 0; c < 3; ++c) table->pixels.push_back(static_cast<std::uint8_t>(std::lround(color[c])));
    const float opacity = colors.mode == VolumeMode::minimum ? 1.0f : std::min(place / kOpaque, 1.0f);
    table->pixels.push_back(static_cast<std::uint8_t>(std::lround(opacity * 255)));
  }
  return table;
}

}  // namespace

std::uint32_t draft_stride(const VolumeGrid& grid) {
  constexpr std::uint64_t kDraftVoxels = std::uint64_t{1} << 20;
  const std::uint64_t voxels = std::uint64_t{grid.kept(0)} * grid.kept(1) * grid.kept(2);
  std::uint32_t stride = 1;
  while (voxels / (std::uint64_t{stride} * stride * stride) > kDraftVoxels) ++stride;
  return stride;
}

DerivedContent<vrml::Mesh> isosurface_mesh(const std::shared_ptr<const VolumeGrid>& grid, float isovalue,
                                           const WorldBudget& budget, Progress* progress, std::size_t most_triangles,
                                           std::uint32_t stride) {
  qnv::IsosurfaceOptions options;
  options.isovalue = static_cast<double>(isovalue);
  for (;; stride *= 2) {
    SurfaceJoiner joiner(budget, most_triangles);
    bool whole = true;
    const auto add = [&](std::span<const qnv::Triangle> triangles) { return whole = joiner.add(triangles); };
    std::optional<qnv::VolumeError> problem;
    if (stride == 1 && grid->step() == 1 && !grid->bricks().empty()) {
      for (const qnv::VolumeSource& part : surface_parts(grid))
        if (!problem && whole) problem = qnv::isosurface(part, options, add, progress);
    } else {
      problem = qnv::isosurface(source_of(grid, stride), options, add, progress);
    }
    if (problem) return problem->message;
    if (whole) return joiner.take();
    if (!joiner.excess()) return "the isosurface needs " + budget->refusal(Resource::meshes);
    if (std::max({grid->kept(0), grid->kept(1), grid->kept(2)}) / stride < 16)
      return std::string("the isosurface has too many triangles");
  }
}

DerivedContent<VolumeProjection> projection_of(const VolumeGrid& grid, const ProjectionColors& colors,
                                               const WorldBudget& budget, std::size_t most_voxels) {
  struct Held {
    VolumeProjection projection;
    Share share;
  };
  auto held = std::make_shared<Held>();
  held->share = Share(budget, Resource::pixels);
  std::uint32_t stride = 1;
  std::array<std::uint32_t, 3> size{};
  std::size_t count = 0;
  const auto sample = [&] {
    count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) count *= size[axis] = (grid.kept(axis) - 1) / stride + 1;
  };
  for (sample(); count > std::max<std::size_t>(most_voxels, 1); sample()) ++stride;
  // Finer parts of a volume that is larger than memory have more voxels.
  const FineValues fine(grid, stride == 1 ? FineValues::factor_for(grid, most_voxels) : 1);
  if (stride == 1) {
    size = fine.size();
    count = std::size_t{size[0]} * size[1] * size[2];
  }
  if (!held->share.grow(2 * count)) return "the projection needs " + budget->refusal(Resource::pixels);
  auto image = std::make_shared<render::Image>();
  image->width = size[0];
  image->height = size[1] * size[2];
  image->slices = size[2];
  image->components = 1;
  image->pixels.resize(count);
  const auto [least, most] = colors.window.value_or(grid.value_range());
  const float scale = most > least ? 255 / (most - least) : 0;
  const std::uint8_t missing = colors.mode == VolumeMode::minimum ? 255 : 0;
  parallel_for(size[2], [&, least = least](std::size_t z) {
    std::vector<float> finer;
    if (stride == 1 && !grid.bricks().empty())
      fine.read({0, 0, static_cast<std::uint32_t>(z)}, {size[0], size[1], 1}, finer);
    const std::span<const float> slice =
        finer.empty() ? grid.kept_slice(static_cast<std::uint32_t>(z) * stride) : std::span<const float>(finer);
    const std::size_t row = finer.empty() ? grid.kept(0) : size[0];
    for (std::size_t y = 0; y < size[1]; ++y) {
      // Images begin at the top row of each slice.
      std::uint8_t* to = image->pixels.data() + ((z + 1) * size[1] - 1 - y) * size[0];
      const float* from = slice.data() + y * stride * row;
      for (std::size_t x = 0; x < size[0]; ++x) {
        const float value = from[x * stride];
        to[x] = value == value ? static_cast<std::uint8_t>(std::clamp((value - least) * scale, 0.0f, 255.0f) + 0.5f)
                               : missing;
      }
    }
  });
  auto look = std::make_shared<render::VolumeLook>();
  look->voxels = std::move(image);
  look->chains.push_back({{}, true});
  using Projection = render::VolumeLook::Projection;
  look->projection = colors.mode == VolumeMode::maximum   ? Projection::maximum
                     : colors.mode == VolumeMode::minimum ? Projection::minimum
                                                          : Projection::average;
  look->projection_colors = color_table(colors);
  glm::dvec3 corner(0), last(0);
  glm::dmat4& place = held->projection.volume_from_box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto voxels = static_cast<double>(size[static_cast<std::size_t>(axis)]);
    const double step =
        static_cast<double>(grid.step()) * stride / fine.factors()[static_cast<std::size_t>(axis)];
    glm::dvec3 end(0);
    end[axis] = voxels * step;
    const glm::dvec3 edge = grid.place_of(end) - grid.place_of(glm::dvec3(0));
    place[axis] = glm::dvec4(edge, 0);
    look->dimensions[axis] = static_cast<float>(glm::length(edge));
    corner[axis] = -0.5 * step;
    last[axis] = (voxels - 0.5) * step;
  }
  place[3] = glm::dvec4(grid.place_of((corner + last) / 2.0), 1);
  held->projection.look = std::move(look);
  return std::shared_ptr<const VolumeProjection>(held, &held->projection);
}

DerivedContent<qnv::Geometry> vectors_of_share(const std::shared_ptr<const VolumeGrid>& grid, const qnv::Volume& of,
                                               float share, const WorldBudget& budget, Progress* progress) {
  qnv::GradientOptions options;
  options.fraction = static_cast<double>(share);
  options.vectors = kMostVectors;
  options.range = of.description.value_range;
  auto found = qnv::gradient_vectors(source_of(grid), options, progress);
  if (const auto* problem = std::get_if<qnv::VolumeError>(&found)) return problem->message;
  auto& made = std::get<qnv::Volume>(found);
  const double total = made.description.total;
  const float spacing = made.description.spacing;
  static_cast<qnv::GeometryBase&>(made) = of;
  made.description.total = total;
  made.description.spacing = spacing;
  made.values = of.values;
  auto held = hold_geometry(std::move(made), budget);
  if (!held) return "the vectors need " + budget->refusal(Resource::vectors);
  return held;
}

}  // namespace gs::app
