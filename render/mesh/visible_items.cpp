#include "render/mesh/visible_items.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

namespace gs::render {
namespace {

/// Returns the item's box in world space, enlarged for rounding errors. Returns an empty box if unknown.
Box box_of(const DrawItem& item) {
  constexpr double kRounding = 1e-6;
  Box box;
  if (!item.mesh || item.mesh->bounds.empty()) return box;
  const glm::dvec3 lower(item.mesh->bounds.lower), upper(item.mesh->bounds.upper);
  const glm::dvec3 center = (lower + upper) * 0.5, half = (upper - lower) * 0.5;
  const glm::dvec3 moved(item.world_from_node * glm::dvec4(center, 1));
  for (int i = 0; i < 3; ++i) {
    double extent = std::abs(moved[i]) * kRounding;
    for (int k = 0; k < 3; ++k) extent += std::abs(item.world_from_node[k][i]) * half[k] * (1 + kRounding);
    box.lower[i] = static_cast<float>(moved[i] - extent);
    box.upper[i] = static_cast<float>(moved[i] + extent);
  }
  return std::isfinite(glm::dot(box.lower * 0.0f + box.upper * 0.0f, glm::vec3(1))) ? box : Box{};
}

}  // namespace

Frustum::Frustum(const glm::dmat4& camera_from_world, const glm::vec2& tangents, double near_plane, double far_plane,
                 const glm::vec2& center) {
  const glm::dvec2 low = glm::dvec2(center) - glm::dvec2(tangents), high = glm::dvec2(center) + glm::dvec2(tangents);
  // Planes in camera space; the camera looks along -Z.
  const std::array<std::pair<glm::dvec3, double>, 6> functions = {{{{0, 0, -1}, -near_plane},
                                                                   {{0, 0, 1}, far_plane},
                                                                   {{-1, 0, -high.x}, 0},
                                                                   {{1, 0, low.x}, 0},
                                                                   {{0, -1, -high.y}, 0},
                                                                   {{0, 1, low.y}, 0}}};
  const glm::dmat3 linear(camera_from_world);
  const glm::dvec3 origin(camera_from_world[3]);
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto& [normal, offset] = functions[i];
    planes[i] = {glm::transpose(linear) * normal, glm::dot(normal, origin) + offset};
  }
}

bool Frustum::misses(const glm::vec3& lower, const glm::vec3& upper) const {
  constexpr double kSlack = 1 + 1e-4;  // margin for rounding errors of later tests
  for (const Plane& plane : planes) {
    double nearest = plane.offset, size = 0;
    for (int i = 0; i < 3; ++i) {
      const double n = plane.normal[i];
      nearest += n * (0.5 * (double{lower[i]} + double{upper[i]}));
      size += std::abs(n) * (0.5 * (double{upper[i]} - double{lower[i]}));
    }
    if (nearest + size * kSlack < 0) return true;
  }
  return false;
}

void VisibleItems::make(const RenderList& list, Kept& kept) {
  kept.made = true;
  kept.told = list.moved.size();
  kept.loose.clear();
  kept.is_loose.assign(list.items.size(), false);
  std::vector<BoxTree::Entry> entries;
  entries.reserve(list.items.size());
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const Box box = box_of(list.items[i]);
    entries.push_back({box, i});
    if (!box.empty()) continue;
    kept.is_loose[i] = true;
    kept.loose.push_back(i);
  }
  kept.tree = BoxTree(std::move(entries));
}

VisibleItems::Kept& VisibleItems::kept_of(const RenderList& list) {
  for (Kept& kept : kept_)
    if (kept.generation == list.generation) return kept;
  if (kept_.size() < kMaxKept) return kept_.emplace_back();
  return *std::min_element(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.used < b.used; });
}

const std::vector<std::uint32_t>* VisibleItems::find(const RenderList& list, const Frustum& frustum) {
  ++calls_;
  const std::size_t count = list.items.size();
  if (list.generation == 0 || count < kMinItems) return nullptr;
  Kept& kept = kept_of(list);
  kept.used = calls_;
  if (kept.generation != list.generation) {
    kept = {};
    kept.generation = list.generation;
    kept.used = calls_;
    kept.told = list.moved.size();
    return nullptr;
  }
  const std::size_t moved = list.moved.size() - kept.told;
  kept.quiet = moved <= count / 64 ? kept.quiet + 1 : 0;
  if (!kept.made && kept.quiet == 0) {
    kept.told = list.moved.size();
    return nullptr;
  }
  if (!kept.made || (kept.loose.size() > count / 8 && kept.quiet >= kQuiet)) make(list, kept);
  for (; kept.told < list.moved.size(); ++kept.told) {
    const std::uint32_t item = list.moved[kept.told];
    if (kept.is_loose[item]) continue;
    kept.is_loose[item] = true;
    kept.loose.push_back(item);
  }
  if (kept.loose.size() > count / 2) return nullptr;

  found_bits_.assign((count + 63) / 64, 0);
  const auto add = [&](std::uint32_t item) {
    found_bits_[item / 64] |= std::uint64_t{1} << item % 64;
    return true;
  };
  for (const std::uint32_t item : kept.loose) (void)add(item);
  kept.tree.visit_unless([&](const glm::vec3& lower, const glm::vec3& upper) { return frustum.misses(lower, upper); },
                         add);
  found_.clear();
  for (std::size_t word = 0; word < found_bits_.size(); ++word)
    for (std::uint64_t bits = found_bits_[word]; bits != 0; bits &= bits - 1)
      found_.push_back(static_cast<std::uint32_t>(word * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
  return &found_;
}

}  // namespace gs::render
