#include "qnv/codecs/displaced/tessellation/for_each_marked.h"
#include "qnv/codecs/displaced/tessellation/patch_evaluator.h"
#include "qnv/codecs/displaced/tessellation/patch_kernel.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>

namespace gs::qnv {
namespace {

using displaced::kNone;
using displaced::Patches;

glm::vec3 unit(const glm::vec3& v) {
  const float length = glm::length(v);
  return length > 0 ? v / length : glm::vec3(0);
}

/// Sums the cross products of a patch's triangles at its rim vertices. Order: corners, then each edge from corner k to
/// corner k + 1. `products` has the order of PatchLoops::products.
void sum_rim(const Columns& products, std::size_t n, glm::vec3* to) {
  const auto upright = [&](std::size_t i, std::size_t j) { return products.at(upright_row(j, n) + i); };
  const auto turned = [&](std::size_t i, std::size_t j) { return products.at(turned_row(j, n) + i); };
  const auto sum_of = [](const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return ((glm::vec3(0) + a) + b) + c;
  };
  *to++ = glm::vec3(0) + upright(0, 0);
  *to++ = glm::vec3(0) + upright(n - 1, 0);
  *to++ = glm::vec3(0) + upright(0, n - 1);
  for (std::size_t t = 1; t < n; ++t) *to++ = sum_of(upright(t, 0), upright(t - 1, 0), turned(t - 1, 0));
  for (std::size_t t = 1; t < n; ++t)
    *to++ = sum_of(upright(n - t - 1, t), upright(n - t, t - 1), turned(n - t - 1, t - 1));
  for (std::size_t t = 1; t < n; ++t) *to++ = sum_of(upright(0, n - t), upright(0, n - t - 1), turned(0, n - t - 1));
}

}  // namespace

void PatchEvaluator::find_normals(const displaced::Surface& surface, int level, std::span<const glm::vec3> places,
                                  std::span<const glm::vec3> shifts, const Marks& inner, const Marks& edges,
                                  RawVector<glm::vec3>* normals, RawVector<std::uint32_t>* packed) {
  const Patches &patches = surface.patches(), &slots = surface.slots();
  const std::size_t n = std::size_t{1} << level, rim = 3 * n;
  const PatchLoops& loops = patch_loops().front();
  if (normals) normals->resize(slots.vertices_at(level));
  if (packed) packed->resize(slots.vertices_at(level));
  const auto write = [&](const Columns& made, std::size_t count, std::size_t to) {
    if (normals)
      for (std::size_t i = 0; i < count; ++i) (*normals)[to + i] = made.at(i);
    if (!packed) return;
    thread_local std::vector<std::uint32_t> some;
    some.resize(std::max(some.size(), count + Columns::kRoom));
    loops.pack_directions(made, count, some.data());
    std::copy_n(some.begin(), count, packed->begin() + static_cast<std::ptrdiff_t>(to));
  };
  // The owner of a slot needs the sums of all patches around the slot.
  Marks around = edges;
  for (std::uint32_t p = 0; p < edges.size(); ++p)
    for (std::uint32_t k = 0; k < 3 && edges[p]; ++k) {
      const std::uint32_t slot = slots.triangles()[p][k];
      const Patches::Edge& edge = slots.edges()[slots.edge(p, k)];
      if (edge.owner == p && edge.other != kNone) around[edge.other] = 1;
      if (slots.owner(slot) == p)
        for (const SlotCorner& corner : corners_of_slot_[slot]) around[corner.patch] = 1;
    }
  rims_.resize(std::max(rims_.size(), patches.size() * rim));
  for_each_marked(around, [&](std::uint32_t p) {
    thread_local Columns at, products, made;
    gather(patches, p, level, places, shifts, at);
    loops.products(at, n, products);
    sum_rim(products, n, rims_.data() + p * rim);
    if (!inner[p] || n < 3) return;
    loops.inner_normals(products, n, made);
    write(made, (n - 1) * (n - 2) / 2, slots.inner_start(p, level));
  });
  for_each_marked(edges, [&](std::uint32_t p) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t slot = slots.triangles()[p][k];
      if (slots.owner(slot) == p) {
        glm::vec3 sum(0);
        for (const SlotCorner& corner : corners_of_slot_[slot]) sum += rims_[corner.patch * rim + corner.corner];
        if (normals) (*normals)[slot] = unit(sum);
        if (packed) (*packed)[slot] = pack_direction(unit(sum));
      }
      const std::uint32_t e = slots.edge(p, k);
      const Patches::Edge& edge = slots.edges()[e];
      if (edge.owner != p) continue;
      struct Along {
        const glm::vec3* sums = nullptr;
        bool same_way = true;
      };
      std::array<Along, 2> sides{};
      for (std::size_t s = 0; s < 2; ++s) {
        const std::uint32_t side = s == 0 ? edge.owner : edge.other;
        if (side == kNone) continue;
        std::uint32_t at = 0;
        while (at < 2 && slots.edge(side, at) != e) ++at;
        sides[s] = {rims_.data() + side * rim + 3 + at * (n - 1), slots.triangles()[side][at] == edge.from};
      }
      thread_local Columns all, made;
      all.resize(n);
      for (std::size_t t = 1; t < n; ++t) {
        glm::vec3 sum(0);
        for (const Along& side : sides)
          if (side.sums) sum += side.sums[(side.same_way ? t : n - t) - 1];
        all.put(t - 1, sum);
      }
      loops.directions(all, n - 1, made);
      write(made, n - 1, slots.edge_start(e, level));
    }
  });
}

}  // namespace gs::qnv
