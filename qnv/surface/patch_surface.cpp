#include "qnv/surface/patch_surface.h"

#include "qnv/base/finite.h"
#include "qnv/base/parallel.h"
#include "qnv/displaced/subdivision.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace gs::qnv {

std::uint32_t pack_direction(const glm::vec3& unit) {
  const auto part = [](float v, float most) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(std::clamp(v, -1.0f, 1.0f) * most)));
  };
  return (part(unit.x, 1023) & 0x7ffu) | (part(unit.y, 1023) & 0x7ffu) << 11 | (part(unit.z, 511) & 0x3ffu) << 22;
}

std::shared_ptr<const PatchSurface> PatchSurface::make(const displaced::Surface& surface, int level, const Box& box) {
  const std::vector<glm::vec3> places = surface.positions(level);
  const std::vector<glm::vec3> normals = displaced::slot_normals(surface.patches(), surface.slots(), level, places);
  const std::vector<Rgb8> colors = surface.vertex_colors(level);
  return make(surface, level, box, {places, normals, colors, nullptr, nullptr});
}

std::shared_ptr<const PatchSurface> PatchSurface::make(const displaced::Surface& surface, int level, const Box& box,
                                                       const Worked& worked) {
  const displaced::Patches &patches = surface.patches(), &slots = surface.slots();
  auto made = std::make_shared<PatchSurface>();
  made->level_ = level;
  made->vertex_count_ = slots.vertices_at(level);
  made->colored_ = !worked.colors.empty();
  const displaced::Frame frame(box);
  const PatchSurface* former = worked.former;
  const std::size_t n = std::size_t{1} << level, count = patches.size(), blocks = (count + kBlock - 1) / kBlock;
  const auto has_changed = [&](std::size_t p) { return !former || !worked.changed || (*worked.changed)[p] != 0; };
  made->blocks_.resize(static_cast<std::size_t>(level) + 1);
  for (auto& of_level : made->blocks_) of_level.resize(blocks);
  if (former) {
    made->edges_ = former->edges_;
    made->patch_edges_ = former->patch_edges_;
    made->bounds_ = former->bounds_;
  } else {
    made->edges_.reserve(patches.edges().size());
    for (const displaced::Patches::Edge& edge : patches.edges())
      made->edges_.push_back({edge.owner, edge.other, {}, 0, 0});
    made->patch_edges_.resize(count);
    for (std::uint32_t p = 0; p < count; ++p)
      for (std::uint32_t k = 0; k < 3; ++k) made->patch_edges_[p][k] = patches.edge(p, k);
    made->bounds_.resize(count);
  }
  parallel_for(blocks, [&](std::size_t b) {
    const std::size_t first = b * kBlock, last = std::min(first + kBlock, count);
    bool changed = false;
    for (std::size_t p = first; p < last; ++p) changed = changed || has_changed(p);
    std::vector<std::shared_ptr<Block>> block(made->blocks_.size());
    for (std::size_t l = 0; l < block.size(); ++l) {
      if (!changed && l < former->blocks_.size()) {
        made->blocks_[l][b] = former->blocks_[l][b];
        continue;
      }
      block[l] = std::make_shared<Block>();
      block[l]->vertices.reserve((last - first) * new_patch_vertices(static_cast<int>(l)));
    }
    std::vector<std::uint32_t> grid, slot_grid;
    for (std::size_t p = first; p < last && (changed || block.back()); ++p) {
      patches.grid(static_cast<std::uint32_t>(p), level, grid);
      slots.grid(static_cast<std::uint32_t>(p), level, slot_grid);
      for (std::size_t l = 0; l < block.size(); ++l) {
        if (!block[l]) continue;
        const std::size_t step = n >> l;
        for (const displaced::GridPlace& at : patch_table(static_cast<int>(l)).places) {
          const std::size_t i = displaced::row_start(at.j * step, n) + at.i * step;
          const glm::vec3 place = frame.outside(worked.places[grid[i]]);
          block[l]->vertices.push_back(
              {finite(place) ? place : frame.lower, pack_direction(worked.normals[slot_grid[i]])});
          if (made->colored_) block[l]->colors.push_back(worked.colors[grid[i]]);
        }
      }
    }
    for (std::size_t l = 0; l < block.size(); ++l) {
      if (!block[l]) continue;
      std::shared_ptr<const Block>& to = made->blocks_[l][b];
      to = std::move(block[l]);
      if (!former || l >= former->blocks_.size()) continue;
      if (const auto& before = former->blocks_[l][b]; *before == *to) to = before;
    }
  });
  const bool deeper = former && former->level_ != level;
  parallel_for(blocks, [&](std::size_t b) {
    for (std::size_t p = b * kBlock; p < std::min((b + 1) * kBlock, count); ++p)
      if (deeper || has_changed(p)) made->measure(p);
  });
  return made;
}

void PatchSurface::measure(std::size_t patch) {
  const PatchTable& table = patch_table(level_);
  std::vector<glm::vec3> at;
  at.reserve(patch_vertices(level_));
  Bounds& bounds = bounds_[patch];
  bounds = {};
  Box& box = bounds.box;
  for (int l = 0; l <= level_; ++l) {
    const PatchVertex* v = vertices(patch, l);
    for (std::size_t i = 0; i < new_patch_vertices(l); ++i) {
      at.push_back(v[i].position);
      box.add(v[i].position);
    }
  }
  bounds.center = box.lower * 0.5f + box.upper * 0.5f;
  for (const glm::vec3& p : at) bounds.radius = std::max(bounds.radius, glm::length(p - bounds.center));
  // Of triangles of all levels: a coarser one may be turned further than those that take its place.
  glm::vec3 sum(0);
  std::vector<glm::vec3> normals;
  const auto add = [&](const std::array<PatchTable::Number, 3>& t) {
    const glm::vec3 cross = glm::cross(at[t[1]] - at[t[0]], at[t[2]] - at[t[0]]);
    const float length = glm::length(cross);
    if (!(length > 0)) return;
    normals.push_back(cross / length);
    sum += cross;
  };
  for (int l = 0; l <= level_; ++l) {
    for (const auto& t : patch_table(l).inner) add(t);
    for (const auto& t : patch_table(l).border) add(t);
  }
  if (const float length = glm::length(sum); length > 0 && finite(sum)) {
    bounds.axis = sum / length;
    bounds.cosine = 1;
    for (const glm::vec3& normal : normals) bounds.cosine = std::min(bounds.cosine, glm::dot(normal, bounds.axis));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    Edge& edge = edges_[patch_edges_[patch][k]];
    if (edge.owner != patch) continue;
    const std::vector<PatchTable::Number>& along = table.edges[k];
    edge.length = edge.radius = 0;
    edge.center = at[along.front()] * 0.5f + at[along.back()] * 0.5f;
    for (std::size_t i = 0; i < along.size(); ++i) {
      edge.radius = std::max(edge.radius, glm::length(at[along[i]] - edge.center));
      if (i > 0) edge.length += glm::length(at[along[i]] - at[along[i - 1]]);
    }
  }
}

std::size_t PatchSurface::bytes() const {
  std::size_t bytes = size() * (sizeof(Bounds) + 12) + edges_.size() * sizeof(Edge);
  for (int l = 0; l <= level_; ++l)
    bytes += size() * new_patch_vertices(l) * (sizeof(PatchVertex) + (colored_ ? sizeof(Rgb8) : 0));
  return bytes;
}

std::size_t PatchSurface::shared_bytes(const PatchSurface& other) const {
  std::size_t bytes = 0;
  for (std::size_t l = 0; l < std::min(blocks_.size(), other.blocks_.size()); ++l)
    for (std::size_t b = 0; b < std::min(blocks_[l].size(), other.blocks_[l].size()); ++b)
      if (blocks_[l][b] == other.blocks_[l][b])
        bytes += blocks_[l][b]->vertices.size() * sizeof(PatchVertex) + blocks_[l][b]->colors.size() * sizeof(Rgb8);
  return bytes;
}

std::size_t SurfacePatches::vertex_count() const {
  std::size_t count = 0;
  for (const auto& part : parts) count += part->vertex_count();
  return count;
}

std::size_t SurfacePatches::bytes() const {
  std::size_t bytes = 0;
  for (const auto& part : parts) bytes += part->bytes();
  return bytes;
}

Box SurfacePatches::box() const {
  Box box;
  for (const auto& part : parts)
    for (std::size_t p = 0; p < part->size(); ++p) {
      box.add(part->bounds(p).box.lower);
      box.add(part->bounds(p).box.upper);
    }
  return box;
}

}  // namespace gs::qnv
