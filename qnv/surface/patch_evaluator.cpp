#include "qnv/surface/patch_evaluator.h"

#include "qnv/base/finite.h"
#include "qnv/base/parallel.h"
#include "qnv/displaced/subdivision.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace gs::qnv {
namespace {

using displaced::EdgeWalk;
using displaced::kLayers;
using displaced::kNone;
using displaced::LevelNumbers;
using displaced::NewVertex;
using displaced::Patches;
using displaced::row_start;
using displaced::Surface;

constexpr std::size_t kAtOnce = 16;  // patches of one task

bool put(glm::vec3& to, const glm::vec3& value) {
  const bool changed = std::memcmp(&to, &value, sizeof(value)) != 0;
  to = value;
  return changed;
}

/// The number of a vertex of a patch.
std::uint32_t number_of(const Patches& patches, int level, std::uint32_t patch, std::uint32_t i, std::uint32_t j) {
  const std::uint32_t n = std::uint32_t{1} << level;
  const auto on_edge = [&](std::uint32_t k, std::uint32_t t) {
    const std::uint32_t e = patches.edge(patch, k);
    const bool same_way = patches.edges()[e].from == patches.triangles()[patch][k];
    return static_cast<std::uint32_t>(patches.edge_start(e, level)) + (same_way ? t : n - t) - 1;
  };
  if (j == 0) return i == 0 ? patches.triangles()[patch][0] : i == n ? patches.triangles()[patch][1] : on_edge(0, i);
  if (j == n) return patches.triangles()[patch][2];
  if (i + j == n) return on_edge(1, j);
  if (i == 0) return on_edge(2, n - j);
  // Rows of n - 2, n - 3, ... come before.
  const std::uint32_t before = (j - 1) * (n - 1) - (j - 1) * j / 2;
  return static_cast<std::uint32_t>(patches.inner_start(patch, level)) + before + i - 1;
}

/// The sum of the products of the triangles of a patch at one of its vertices.
glm::vec3 sum_at(const Patches& patches, int level, std::span<const glm::vec3> places, std::uint32_t patch,
                 std::uint32_t i, std::uint32_t j) {
  const std::uint32_t n = std::uint32_t{1} << level;
  glm::vec3 sum(0);
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return places[number_of(patches, level, patch, x, y)]; };
  const auto add = [&](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) { sum += glm::cross(b - a, c - a); };
  const auto upright = [&](std::uint32_t x, std::uint32_t y) { add(at(x, y), at(x + 1, y), at(x, y + 1)); };
  const auto turned = [&](std::uint32_t x, std::uint32_t y) {
    if (x + y + 1 < n) add(at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
  };
  if (i + j < n) upright(i, j);
  if (i > 0) upright(i - 1, j);
  if (j > 0) upright(i, j - 1);
  if (i > 0) turned(i - 1, j);
  if (i > 0 && j > 0) turned(i - 1, j - 1);
  if (j > 0) turned(i, j - 1);
  return sum;
}

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

/// Calls work(patch) for the marked ones.
template <class Work>
void for_each_marked(const std::vector<char>& marks, const Work& work) {
  std::vector<std::uint32_t> marked;
  for (std::uint32_t p = 0; p < marks.size(); ++p)
    if (marks[p]) marked.push_back(p);
  const std::size_t tasks = (marked.size() + kAtOnce - 1) / kAtOnce;
  const auto task = [&](std::size_t t) {
    for (std::size_t i = t * kAtOnce; i < std::min((t + 1) * kAtOnce, marked.size()); ++i) work(marked[i]);
  };
  if (tasks == 1) task(0);
  if (tasks > 1) parallel_for(tasks, task);
}

}  // namespace

void PatchEvaluator::changed(const displaced::ClusterHeader& cluster, std::uint32_t patches) {
  if (cluster.first >= patches || cluster.count > patches - cluster.first) return;  // it was refused
  const auto l = static_cast<std::size_t>(cluster.level);
  if (marks_.size() <= l) marks_.resize(l + 1);
  // Level 1 brings numbers of the base, too.
  for (std::size_t at = l == 1 ? 0 : l; at <= l; ++at) {
    marks_[at].resize(patches, 0);
    std::fill_n(marks_[at].begin() + cluster.first, cluster.count, 1);
  }
}

void PatchEvaluator::prepare(const Surface& surface) {
  const Patches &patches = surface.patches(), &slots = surface.slots();
  patches_of_corner_.resize(patches.base_vertices());
  corners_of_slot_.resize(slots.base_vertices());
  for (std::uint32_t p = 0; p < patches.size(); ++p)
    for (std::uint32_t k = 0; k < 3; ++k) {
      patches_of_corner_[patches.triangles()[p][k]].push_back(p);
      corners_of_slot_[slots.triangles()[p][k]].push_back({p, k});
    }
}

void PatchEvaluator::work_out_base(const Surface& surface, Changes& changes) {
  std::vector<glm::vec3> places = surface.base_positions(), shifts(places.size(), glm::vec3(0));
  const std::vector<glm::vec3> normals = surface.base_normals(places);
  for (int layer = 0; layer < kLayers; ++layer)
    if (const LevelNumbers* numbers = surface.find(layer, 0))
      for (std::size_t v = 0; v < places.size(); ++v)
        (layer == 0 ? places : shifts)[v] +=
            normals[v] * (surface.step(layer) * static_cast<float>(numbers->normal[v]));
  Level& base = levels_[0];
  base.places.resize(places.size());
  base.shifts.resize(places.size());
  for (std::size_t v = 0; v < places.size(); ++v) {
    const bool moved = put(base.places[v], places[v]), shifted = put(base.shifts[v], shifts[v]);
    if (!moved && !shifted) continue;
    changes.corners[v] = 1;
    changes.any = true;
  }
}

void PatchEvaluator::work_out(const Surface& surface, int level, std::uint32_t patch, Changes& changes,
                              Scratch& scratch) {
  const Patches &patches = surface.patches(), &slots = surface.slots();
  const Level& before = levels_[static_cast<std::size_t>(level) - 1];
  Level& now = levels_[static_cast<std::size_t>(level)];
  std::array<const LevelNumbers*, kLayers> numbers{};
  for (int layer = 0; layer < kLayers; ++layer) numbers[static_cast<std::size_t>(layer)] = surface.find(layer, level);
  const auto keep = [&](std::uint32_t v, std::uint32_t from, char& changed) {
    const bool moved = put(now.places[v], before.places[from]), shifted = put(now.shifts[v], before.shifts[from]);
    if (moved || shifted) changed = 1;
  };
  const auto make = [&](const NewVertex& fresh, char& changed) {
    const std::uint32_t v = fresh.vertex;
    const bool line = fresh.edge != kNone && patches.edges()[fresh.edge].line();
    const displaced::Prediction p = displaced::predict(fresh, line, before.places, before.normals);
    const auto moved_by = [&](int layer) {
      const LevelNumbers* of = numbers[static_cast<std::size_t>(layer)];
      if (!of) return glm::vec3(0);
      glm::vec3 by = p.normal * (surface.step(layer) * static_cast<float>(of->normal[v]));
      if (line)
        by += p.sideways * (surface.step(layer) * static_cast<float>(of->sideways[v - patches.base_vertices()]));
      return by;
    };
    glm::vec3 shift = 0.5f * (before.shifts[fresh.a] + before.shifts[fresh.b]);
    for (int layer = 1; layer < kLayers; ++layer) shift += moved_by(layer);
    const bool moved = put(now.places[v], p.position + moved_by(0)), shifted = put(now.shifts[v], shift);
    if (moved || shifted) changed = 1;
  };
  const auto n = std::uint32_t{1} << level, half = n / 2;
  for (const std::uint32_t v : patches.triangles()[patch])
    if (patches.owner(v) == patch) keep(v, v, changes.corners[v]);
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t e = patches.edge(patch, k);
    const Patches::Edge& edge = patches.edges()[e];
    if (edge.owner != patch) continue;
    const auto start = static_cast<std::uint32_t>(patches.edge_start(e, level));
    const EdgeWalk walk(patches, e, edge.owner, patches, level - 1), slot(patches, e, edge.owner, slots, level - 1);
    const EdgeWalk other(patches, e, edge.crease ? edge.other : edge.owner, slots, level - 1);
    for (std::uint32_t t = 1; t < n; ++t) {
      if (t % 2 == 0)
        keep(start + t - 1, walk(t / 2), changes.edges[e]);
      else
        make(NewVertex{start + t - 1, walk(t / 2), walk(t / 2 + 1), e, slot(t / 2), slot(t / 2 + 1), other(t / 2),
                       other(t / 2 + 1)},
             changes.edges[e]);
    }
  }
  if (level == 1) return;
  patches.grid(patch, level - 1, scratch.grid);
  slots.grid(patch, level - 1, scratch.slots);
  auto v = static_cast<std::uint32_t>(patches.inner_start(patch, level));
  for (std::uint32_t j = 1; j + 1 < n; ++j)
    for (std::uint32_t i = 1; i + j < n; ++i, ++v) {
      const auto at = [&](std::uint32_t x, std::uint32_t y) { return row_start(y, half) + x; };
      const std::uint32_t x = i / 2, y = j / 2;
      if (i % 2 == 0 && j % 2 == 0) {
        keep(v, scratch.grid[at(x, y)], changes.inner[patch]);
        continue;
      }
      const std::size_t a = i % 2 == 0 || j % 2 == 0 ? at(x, y) : at(x + 1, y);
      const std::size_t b = j % 2 == 0 ? at(x + 1, y) : at(x, y + 1);
      make(NewVertex{v, scratch.grid[a], scratch.grid[b], kNone, scratch.slots[a], scratch.slots[b], scratch.slots[a],
                     scratch.slots[b]},
           changes.inner[patch]);
    }
}

PatchEvaluator::Marks PatchEvaluator::touched(const Surface& surface, const Changes& changes) const {
  const Patches& patches = surface.patches();
  Marks marks = changes.inner;
  for (std::size_t e = 0; e < changes.edges.size(); ++e)
    if (changes.edges[e])
      for (const std::uint32_t p : {patches.edges()[e].owner, patches.edges()[e].other})
        if (p != kNone) marks[p] = 1;
  for (std::size_t v = 0; v < changes.corners.size(); ++v)
    if (changes.corners[v])
      for (const std::uint32_t p : patches_of_corner_[v]) marks[p] = 1;
  return marks;
}

PatchEvaluator::Marks PatchEvaluator::around(const Surface& surface, const Marks& marks) const {
  Marks wider = marks;
  for (std::uint32_t p = 0; p < marks.size(); ++p)
    if (marks[p])
      for (const std::uint32_t v : surface.patches().triangles()[p])
        for (const std::uint32_t other : patches_of_corner_[v]) wider[other] = 1;
  return wider;
}

void PatchEvaluator::find_normals(const Surface& surface, int level, std::span<const glm::vec3> places,
                                  const Marks& inner, const Marks& edges, std::vector<glm::vec3>& normals) const {
  const Patches &patches = surface.patches(), &slots = surface.slots();
  const auto n = std::uint32_t{1} << level;
  normals.resize(slots.vertices_at(level));
  for_each_marked(edges, [&](std::uint32_t p) {
    // Who owns a slot sums up what lies around it.
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t slot = slots.triangles()[p][k];
      if (slots.owner(slot) == p) {
        glm::vec3 sum(0);
        for (const SlotCorner& corner : corners_of_slot_[slot])
          sum += sum_at(patches, level, places, corner.patch, corner.corner == 1 ? n : 0, corner.corner == 2 ? n : 0);
        normals[slot] = unit(sum);
      }
      const std::uint32_t e = slots.edge(p, k);
      const Patches::Edge& edge = slots.edges()[e];
      if (edge.owner != p) continue;
      const auto start = static_cast<std::uint32_t>(slots.edge_start(e, level));
      for (std::uint32_t t = 1; t < n; ++t) {
        glm::vec3 sum(0);
        for (const std::uint32_t side : {edge.owner, edge.other}) {
          if (side == kNone) continue;
          std::uint32_t at = 0;
          while (at < 2 && slots.edge(side, at) != e) ++at;
          const std::uint32_t along = slots.triangles()[side][at] == edge.from ? t : n - t;
          const std::uint32_t i = at == 0   ? along
                                  : at == 1 ? n - along
                                            : 0,
                              j = at == 0   ? 0
                                  : at == 1 ? along
                                            : n - along;
          sum += sum_at(patches, level, places, side, i, j);
        }
        normals[start + t - 1] = unit(sum);
      }
    }
    if (!inner[p] || n < 3) return;
    thread_local Scratch scratch;
    patches.grid(p, level, scratch.grid);
    scratch.at.resize(scratch.grid.size());
    scratch.sums.assign(scratch.grid.size(), glm::vec3(0));
    for (std::size_t i = 0; i < scratch.grid.size(); ++i) scratch.at[i] = places[scratch.grid[i]];
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      const glm::vec3 cross = glm::cross(scratch.at[b] - scratch.at[a], scratch.at[c] - scratch.at[a]);
      scratch.sums[a] += cross;
      scratch.sums[b] += cross;
      scratch.sums[c] += cross;
    };
    for (std::size_t j = 0; j < n; ++j) {
      const std::size_t row = row_start(j, n), above = row_start(j + 1, n);
      for (std::size_t i = 0; i + j < n; ++i) {
        add(row + i, row + i + 1, above + i);
        if (i + j + 1 < n) add(row + i + 1, above + i + 1, above + i);
      }
    }
    std::size_t to = slots.inner_start(p, level);
    for (std::size_t j = 1; j + 1 < n; ++j)
      for (std::size_t i = 1; i + j < n; ++i) normals[to++] = unit(scratch.sums[row_start(j, n) + i]);
  });
}

std::shared_ptr<const PatchSurface> PatchEvaluator::state(const Surface& surface, int level, const Box& box) {
  const Patches& patches = surface.patches();
  const std::size_t count = patches.size(), depth = static_cast<std::size_t>(level) + 1;
  if (patches_of_corner_.empty()) prepare(surface);
  const std::size_t known = levels_.size();
  levels_.resize(std::max(known, depth));
  marks_.resize(std::max(marks_.size(), depth));
  worked_out_ = 0;
  const Marks all(count, 1);
  Marks wanted(count, 0), changed(count, 0);  // of the level in work; of the last one
  for (std::size_t l = 0; l < depth; ++l) {
    Changes changes{Marks(count, 0), Marks(patches.edges().size(), 0), Marks(patches.base_vertices(), 0), false};
    Marks& marks = marks_[l];
    marks.resize(count, 0);
    if (l >= known) std::fill(marks.begin(), marks.end(), 1);
    for (std::size_t p = 0; p < count; ++p) marks[p] = static_cast<char>(marks[p] | wanted[p]);
    const bool any = std::find(marks.begin(), marks.end(), 1) != marks.end();
    if (any && l == 0) {
      work_out_base(surface, changes);
    } else if (any) {
      levels_[l].places.resize(patches.vertices_at(static_cast<int>(l)));
      levels_[l].shifts.resize(levels_[l].places.size());
      for_each_marked(marks, [&](std::uint32_t p) {
        thread_local Scratch scratch;
        work_out(surface, static_cast<int>(l), p, changes, scratch);
      });
    }
    worked_out_ += static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 1));
    std::fill(marks.begin(), marks.end(), 0);
    changed = touched(surface, changes);
    if (l >= known) std::fill(changed.begin(), changed.end(), 1);
    wanted = around(surface, changed);
    if (l + 1 == depth) break;
    // Who was the last level up to now has none yet.
    const bool fresh = levels_[l].normals.empty();
    if (fresh || std::find(changed.begin(), changed.end(), 1) != changed.end())
      find_normals(surface, static_cast<int>(l), levels_[l].places, fresh ? all : changed, fresh ? all : wanted,
                   levels_[l].normals);
    // Between the first levels a vertex reaches further than to the next patch.
    if (l < 2) wanted = around(surface, wanted);
  }
  if (!last_ || last_->level() != level) changed = wanted = all;
  // What is seen are the places with what all layers add.
  const Level& last = levels_[depth - 1];
  shown_.resize(last.places.size());
  for (std::size_t v = 0; v < shown_.size(); ++v) shown_[v] = last.places[v] + last.shifts[v];
  find_normals(surface, level, shown_, changed, wanted, shown_normals_);
  if (colors_changed_ || !last_ || last_->level() != level) colors_ = surface.vertex_colors(level);
  if (std::exchange(colors_changed_, false)) std::fill(wanted.begin(), wanted.end(), 1);
  last_ = PatchSurface::make(surface, level, box, {shown_, shown_normals_, colors_, &wanted, last_.get()});
  return last_;
}

}  // namespace gs::qnv
