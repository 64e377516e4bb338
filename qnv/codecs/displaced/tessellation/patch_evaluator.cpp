#include "qnv/codecs/displaced/tessellation/patch_evaluator.h"

#include "base/finite.h"
#include "qnv/codecs/displaced/subdivision.h"
#include "qnv/codecs/displaced/tessellation/for_each_marked.h"
#include "qnv/codecs/displaced/tessellation/patch_kernel.h"

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

bool put(glm::vec3& to, const glm::vec3& value) {
  const bool changed = std::memcmp(&to, &value, sizeof(value)) != 0;
  to = value;
  return changed;
}

}  // namespace

void PatchEvaluator::changed(const displaced::ClusterHeader& cluster, std::uint32_t patches) {
  if (cluster.first >= patches || cluster.count > patches - cluster.first) return;  // Surface::add() rejected it
  const auto l = static_cast<std::size_t>(cluster.level);
  if (marks_.size() <= l) marks_.resize(l + 1);
  // A cluster of level 1 also contains numbers of base vertices.
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
  }
}

void PatchEvaluator::work_out(const Surface& surface, int level, std::uint32_t patch, Changes& changes,
                              Scratch& scratch) {
  const Patches &patches = surface.patches(), &slots = surface.slots();
  const Level& before = levels_[static_cast<std::size_t>(level) - 1];
  Level& now = levels_[static_cast<std::size_t>(level)];
  std::array<const LevelNumbers*, kLayers> numbers{};
  std::array<float, kLayers> steps{};
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    numbers[layer] = surface.find(static_cast<int>(layer), level);
    steps[layer] = surface.step(static_cast<int>(layer));
  }
  // On a new level, everything is new, so sets no marks.
  const auto set = [&](std::uint32_t v, const glm::vec3& place, const glm::vec3& shift, char& changed) {
    if (changes.all) {
      now.places[v] = place;
      now.shifts[v] = shift;
      return;
    }
    const bool moved = put(now.places[v], place), shifted = put(now.shifts[v], shift);
    if (moved || shifted) changed = 1;
  };
  const auto keep = [&](std::uint32_t v, std::uint32_t from, char& changed) {
    set(v, before.places[from], before.shifts[from], changed);
  };
  const auto make = [&](const NewVertex& fresh, char& changed) {
    const std::uint32_t v = fresh.vertex;
    const bool line = fresh.edge != kNone && patches.edges()[fresh.edge].line();
    const displaced::Prediction p = displaced::predict(fresh, line, before.places, before.normals);
    const auto moved_by = [&](std::size_t layer) {
      const LevelNumbers* of = numbers[layer];
      if (!of) return glm::vec3(0);
      glm::vec3 by = p.normal * (steps[layer] * static_cast<float>(of->normal[v]));
      if (line) by += p.sideways * (steps[layer] * static_cast<float>(of->sideways[v - patches.base_vertices()]));
      return by;
    };
    glm::vec3 shift = 0.5f * (before.shifts[fresh.a] + before.shifts[fresh.b]);
    for (std::size_t layer = 1; layer < kLayers; ++layer) shift += moved_by(layer);
    set(v, p.position + moved_by(0), shift, changed);
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
  // Computes the inner vertices, row by row.
  gather(patches, patch, level - 1, before.places, {}, scratch.places);
  gather(patches, patch, level - 1, before.shifts, {}, scratch.shifts);
  gather(slots, patch, level - 1, before.normals, {}, scratch.normals);
  const std::size_t count = std::size_t{n - 1} * (n - 2) / 2;
  const auto first = static_cast<std::uint32_t>(patches.inner_start(patch, level));
  scratch.made.resize(half);
  scratch.made_shifts.resize(half);
  scratch.numbers.resize(count);
  PatchMiddles middles{0, &scratch.places, &scratch.shifts, &scratch.normals, 0, 0, {}};
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    if (!numbers[layer]) continue;
    numbers[layer]->normal.copy(first, count, scratch.numbers.data());
    scratch.moved[layer].resize(count);
    for (std::size_t i = 0; i < count; ++i)
      scratch.moved[layer][i] = steps[layer] * static_cast<float>(scratch.numbers[i]);
    scratch.row[layer].resize(half + Columns::kRoom);
    middles.moved[layer] = scratch.row[layer].data();
  }
  char& inside = changes.inner[patch];
  const PatchLoops& loops = patch_loops().front();
  // Computes every second vertex of a row. `from` is the index of the row's first vertex among the patch's inner
  // vertices.
  const auto make_row = [&](std::size_t a, std::size_t b, std::size_t vertices, std::uint32_t from) {
    middles.a = a;
    middles.b = b;
    middles.count = vertices;
    for (std::size_t layer = 0; layer < kLayers; ++layer)
      for (std::size_t i = 0; numbers[layer] && i < vertices; ++i)
        scratch.row[layer][i] = scratch.moved[layer][from + 2 * i];
    loops.middles(middles, scratch.made, scratch.made_shifts);
    for (std::uint32_t i = 0; i < vertices; ++i)
      set(first + from + 2 * i, scratch.made.at(i), scratch.made_shifts.at(i), inside);
  };
  std::uint32_t done = 0;  // number of inner vertices computed so far
  for (std::uint32_t j = 1; j + 1 < n; done += n - 1 - j++) {
    const std::uint32_t y = j / 2;
    const std::size_t row = row_start(y, half), above = row_start(y + 1, half);
    if (j % 2 == 0) {
      make_row(row, row + 1, half - y, done);
      for (std::uint32_t x = 1; x + y < half; ++x)
        set(first + done + 2 * x - 1, scratch.places.at(row + x), scratch.shifts.at(row + x), inside);
    } else {
      make_row(row + 1, above + 1, half - 1 - y, done + 1);
      make_row(row + 1, above, half - 1 - y, done);
    }
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

std::shared_ptr<const PatchSurface> PatchEvaluator::state(const Surface& surface, int level, const Box& box) {
  const Patches& patches = surface.patches();
  const std::size_t count = patches.size(), depth = static_cast<std::size_t>(level) + 1;
  if (patches_of_corner_.empty()) prepare(surface);
  const std::size_t known = levels_.size();
  levels_.resize(std::max(known, depth));
  marks_.resize(std::max(marks_.size(), depth));
  worked_out_ = 0;
  const Marks all(count, 1);
  Marks wanted(count, 0), changed(count, 0);  // to evaluate on this level; changed on the previous level
  for (std::size_t l = 0; l < depth; ++l) {
    Changes changes{Marks(count, 0), Marks(patches.edges().size(), 0), Marks(patches.base_vertices(), 0), l >= known};
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
    // The deepest level of the previous call has no normals yet.
    const bool fresh = levels_[l].normals.empty();
    if (fresh || std::find(changed.begin(), changed.end(), 1) != changed.end())
      find_normals(surface, static_cast<int>(l), levels_[l].places, {}, fresh ? all : changed, fresh ? all : wanted,
                   &levels_[l].normals, nullptr);
    // On levels 0 and 1, a vertex affects more than the adjacent patches.
    if (l < 2) wanted = around(surface, wanted);
  }
  if (!last_ || last_->level() != level) changed = wanted = all;
  // The drawn positions include the displacements of all layers.
  const Level& last = levels_[depth - 1];
  find_normals(surface, level, last.places, last.shifts, changed, wanted, nullptr, &shown_normals_);
  if (colors_changed_ || !last_ || last_->level() != level) colors_ = surface.vertex_colors(level);
  if (std::exchange(colors_changed_, false)) std::fill(wanted.begin(), wanted.end(), 1);
  last_ = PatchSurface::make(surface, level, box,
                             {last.places, last.shifts, shown_normals_, colors_, &wanted, last_.get()});
  return last_;
}

}  // namespace gs::qnv
