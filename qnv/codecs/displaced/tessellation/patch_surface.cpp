#include "qnv/codecs/displaced/tessellation/patch_surface.h"

#include "base/finite.h"
#include "base/parallel.h"
#include "qnv/codecs/displaced/tessellation/patch_kernel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace gs::qnv {

std::uint32_t pack_direction(const glm::vec3& unit) {
  // Rounds like std::lround, but without a function call: halves away from 0. NaN becomes 0.
  const auto part = [](float v, float most) {
    const float scaled = std::clamp(v, -1.0f, 1.0f) * most, size = std::abs(scaled);
    if (!(size <= most)) return 0u;
    const auto whole = static_cast<std::int32_t>(size);
    const std::int32_t rounded = whole + (size - static_cast<float>(whole) >= 0.5f ? 1 : 0);
    return static_cast<std::uint32_t>(scaled < 0 ? -rounded : rounded);
  };
  return (part(unit.x, 1023) & 0x7ffu) | (part(unit.y, 1023) & 0x7ffu) << 11 | (part(unit.z, 511) & 0x3ffu) << 22;
}

std::shared_ptr<const PatchSurface> PatchSurface::make(const displaced::Surface& surface, int level, const Box& box,
                                                       const Worked& worked) {
  const displaced::Patches &patches = surface.patches(), &slots = surface.slots();
  auto made = std::make_shared<PatchSurface>();
  made->level_ = level;
  made->vertex_count_ = slots.vertices_at(level);
  made->colored_ = !worked.colors.empty();
  const displaced::Frame frame(box);
  const PatchLoops& loops = patch_loops().front();
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
      block[l]->vertices.resize((last - first) * new_patch_vertices(static_cast<int>(l)));
    }
    thread_local Columns at;
    std::vector<std::uint32_t> directions(patch_vertices(level));
    std::vector<std::uint32_t> grid;
    for (std::size_t p = first; p < last && (changed || block.back()); ++p) {
      gather(patches, static_cast<std::uint32_t>(p), level, worked.places, worked.shifts, at);
      loops.leave_frame(at, directions.size(), frame.lower, frame.size);
      for_each_of_grid(slots, static_cast<std::uint32_t>(p), level,
                       [&](std::size_t i, std::size_t slot) { directions[i] = worked.normals[slot]; });
      if (made->colored_) patches.grid(static_cast<std::uint32_t>(p), level, grid);
      for (std::size_t l = 0; l < block.size(); ++l) {
        if (!block[l]) continue;
        const std::size_t step = n >> l;
        const auto& places = patch_table(static_cast<int>(l)).places;
        PatchVertex* to = block[l]->vertices.data() + (p - first) * places.size();
        for (const displaced::GridPlace& of : places) {
          const std::size_t i = displaced::row_start(of.j * step, n) + of.i * step;
          *to++ = {at.at(i), directions[i]};
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
  const PatchLoops& loops = patch_loops().front();
  const auto count = patch_vertices(level_);
  thread_local Columns at, grid, products;
  thread_local std::array<Columns, displaced::kDeepestPatch + 1> units;
  at.resize(count);
  Bounds& bounds = bounds_[patch];
  bounds = {};
  Box box;
  std::size_t known = 0;
  for (int l = 0; l <= level_; ++l) {
    const PatchVertex* v = vertices(patch, l);
    for (std::size_t i = 0; i < new_patch_vertices(l); ++i) {
      at.put(known++, v[i].position);
      box.add(v[i].position);
    }
  }
  bounds.box = box;
  bounds.center = box.lower * 0.5f + box.upper * 0.5f;
  bounds.radius = loops.farthest(at, count, bounds.center);
  // Includes the triangles of all levels: a coarse triangle may be turned farther from the axis than its children.
  glm::vec3 sum(0);
  for (int l = 0; l <= level_; ++l) {
    const PatchTable& of_level = patch_table(l);
    const std::size_t n = std::size_t{1} << l;
    grid.resize(of_level.grid.size());
    for (std::size_t i = 0; i < of_level.grid.size(); ++i) grid.put(i, at.at(of_level.grid[i]));
    loops.products(grid, n, products);
    loops.directions(products, n * n, units[static_cast<std::size_t>(l)]);
    for (const PatchTable::Number turn : of_level.turns) sum += products.at(turn);
  }
  if (const float length = glm::length(sum); length > 0 && finite(sum)) {
    bounds.axis = sum / length;
    bounds.cosine = 1;
    for (int l = 0; l <= level_; ++l)
      bounds.cosine = std::min(bounds.cosine, loops.least_cosine(units[static_cast<std::size_t>(l)],
                                                                 std::size_t{1} << (2 * l), bounds.axis));
  }
  for (std::size_t k = 0; k < 3; ++k) {
    Edge& edge = edges_[patch_edges_[patch][k]];
    if (edge.owner != patch) continue;
    const std::vector<PatchTable::Number>& along = table.edges[k];
    edge.length = edge.radius = 0;
    edge.center = at.at(along.front()) * 0.5f + at.at(along.back()) * 0.5f;
    for (std::size_t i = 0; i < along.size(); ++i) {
      edge.radius = std::max(edge.radius, glm::length(at.at(along[i]) - edge.center));
      if (i > 0) edge.length += glm::length(at.at(along[i]) - at.at(along[i - 1]));
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
