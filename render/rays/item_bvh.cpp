#include "render/rays/item_bvh.h"

#include "render/rays/surface_pick.h"
#include "vrml/mesh/vertices.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>

namespace gs::render {
namespace {

constexpr std::size_t kMaxRefits = 64;
constexpr std::size_t kMaxTriangles = std::size_t{1} << 24;  // maximum triangles of all meshes with cached trees

bool is_finite(const glm::dmat4& m) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) sum += glm::dot(m[i] * 0.0, glm::dvec4(1));
  return sum == 0;
}

/// Returns the item's box in world space, enlarged for rounding errors. Returns an empty box if the item cannot be hit.
Box world_box(const DrawItem& item) {
  Box box;
  if (!item.touchable || !item.mesh || item.mesh->empty()) return box;
  if (item.mesh->primitive != vrml::Mesh::Primitive::triangles) return box;
  const Box& bounds = item.mesh->bounds;
  const glm::dmat4& matrix = item.world_from_node;
  if (bounds.empty() || !is_finite(matrix)) return box;
  const glm::dvec3 center = (glm::dvec3(bounds.lower) + glm::dvec3(bounds.upper)) * 0.5,
                   half = glm::dvec3(bounds.upper) - center;
  const glm::dvec3 moved(matrix * glm::dvec4(center, 1));
  constexpr double kRounding = 1e-6;
  for (int i = 0; i < 3; ++i) {
    double extent = std::abs(moved[i]) * kRounding;
    for (int k = 0; k < 3; ++k) extent += std::abs(matrix[k][i]) * half[k] * (1 + kRounding);
    box.lower[i] = static_cast<float>(moved[i] - extent);
    box.upper[i] = static_cast<float>(moved[i] + extent);
  }
  return std::isfinite(glm::dot(box.lower * 0.0f + box.upper * 0.0f, glm::vec3(1))) ? box : Box{};
}

bool is_sought(const DrawItem& item, Sought sought) {
  switch (sought) {
    case Sought::met:
      return item.collidable && !item.overlay;  // overlays move with the viewer, so they are never obstacles
    case Sought::overlay:
      return item.visible && item.overlay && item.touchable;
    default:
      return item.visible && item.touchable;
  }
}

glm::dvec3 world_normal(const DrawItem& item, const glm::dvec3& in_node) {
  const glm::dvec3 normal = glm::transpose(glm::inverse(glm::dmat3(item.world_from_node))) * in_node;
  const double length = glm::length(normal);
  return length > 0 && std::isfinite(length) ? normal / length : glm::dvec3(0);
}

void describe(const DrawItem& item, const vrml::Mesh& mesh, const SightLine& line, SurfaceHit& hit) {
  const std::uint32_t* corners = mesh.indices.data() + std::size_t{3} * hit.triangle.triangle;
  const auto blend = [&](const auto& values) {
    using Value = std::decay_t<decltype(values[0])>;
    Value sum(0);
    for (int i = 0; i < 3; ++i) sum += values[corners[i]] * static_cast<float>(hit.triangle.weights[i]);
    return sum;
  };
  hit.point = line.origin + line.direction * hit.triangle.distance;
  const glm::dvec3 a(mesh.positions[corners[0]]), b(mesh.positions[corners[1]]), c(mesh.positions[corners[2]]);
  glm::dvec3 normal = glm::cross(b - a, c - a);
  if (mesh.normals.size() == mesh.positions.size())
    if (const glm::dvec3 smooth(blend(mesh.normals)); glm::dot(smooth, smooth) > 0) normal = smooth;
  hit.normal = world_normal(item, normal);
  if (mesh.texture_coordinates.size() == mesh.positions.size()) {
    hit.texture_coordinate = blend(mesh.texture_coordinates);
  } else {
    const glm::vec3 point = blend(mesh.positions);
    hit.texture_coordinate = vrml::default_texture_coordinates({&point, 1}, mesh.bounds)[0];
  }
}

/// Part of a line inside of all ClipPlanes of an item: distances from `from` to `to`. Empty if `to` is smaller.
struct Span {
  double from = 0, to = 0;
};
Span span_inside(const RenderList& list, const ClipList& clip_planes, const SightLine& line) {
  Span span{0, line.farthest};
  for (const std::uint16_t index : clip_planes) {
    if (index >= list.clip_planes.size()) continue;
    const glm::dvec4& plane = list.clip_planes[index];
    const double start = glm::dot(plane, glm::dvec4(line.origin, 1)),
                 slope = glm::dot(glm::dvec3(plane), line.direction);
    if (slope == 0) {
      if (start < 0) return {0, -1};
    } else if (slope > 0) {
      span.from = std::max(span.from, -start / slope);
    } else {
      span.to = std::min(span.to, -start / slope);
    }
  }
  return span;
}

}  // namespace

std::size_t ItemBvh::bytes() const {
  std::size_t sum = 0;
  for (const auto& [mesh, kept] : meshes_)
    if (kept.tree->ready) sum += kept.tree->tree->bytes();
  return sum;
}

void ItemBvh::update(const RenderList& list) {
  const bool counted = list.items.size() == items_.size();
  bool changed = !counted;
  std::size_t others = 0;  // number of items with a new mesh
  items_.resize(list.items.size());
  boxes_.resize(list.items.size());
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    Item& known = items_[i];
    // A matrix with NaN never compares equal, so its item is updated each time.
    const bool same_mesh = !known.mesh.owner_before(item.mesh) && !item.mesh.owner_before(known.mesh);
    if (counted && same_mesh && known.world_from_node == item.world_from_node) continue;
    others += same_mesh ? 0 : 1;
    known.mesh = item.mesh;
    known.world_from_node = item.world_from_node;
    if (!counted) known.searched = nullptr, known.tree = nullptr;
    boxes_[i] = world_box(item);
    changed = true;
  }
  if (!changed) return;
  std::erase_if(meshes_, [&](const auto& entry) {
    if (!entry.second.mesh.expired()) return false;
    triangles_ -= entry.second.triangles;
    return true;
  });
  // If most meshes are new, the list was collected again, so build a new tree instead of refitting the old one.
  if (counted && others <= list.items.size() / 8 && ++refits_ <= kMaxRefits) {
    tree_.refit(boxes_);
    return;
  }
  refits_ = 0;
  std::vector<BoxTree::Entry> entries(boxes_.size());
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i] = {boxes_[i], static_cast<std::uint32_t>(i)};
  tree_ = BoxTree(std::move(entries));
}

// Returns the tree of a mesh and starts to build it if necessary. A new mesh may have the address of a deleted mesh;
// the weak pointer has then expired.
std::shared_ptr<ItemBvh::Tree> ItemBvh::tree_of(const std::shared_ptr<const vrml::Mesh>& mesh,
                                                std::size_t max_triangles) {
  const auto known = meshes_.find(mesh.get());
  if (known != meshes_.end() && !known->second.mesh.expired()) {
    known->second.used = searches_;
    if (known->second.triangles >= MeshTrees::kLargeMesh) trees_->ask();
    return known->second.tree;
  }
  if (known != meshes_.end()) {
    triangles_ -= known->second.triangles;
    meshes_.erase(known);
  }
  const std::size_t triangles = mesh->indices.size() / 3;
  if (triangles_ + triangles > max_triangles)
    std::erase_if(meshes_, [&](const auto& entry) {
      if (entry.second.used == searches_) return false;
      triangles_ -= entry.second.triangles;
      return true;
    });
  if (triangles > max_triangles || triangles_ > max_triangles - triangles) return nullptr;
  triangles_ += triangles;
  std::shared_ptr<Tree> tree;
  if (triangles < MeshTrees::kLargeMesh) {
    tree = std::make_shared<Tree>();
    tree->tree.emplace(*mesh);
    tree->ready = true;
  } else {
    tree = trees_->find(mesh);
  }
  meshes_.emplace(mesh.get(), Kept{mesh, triangles, searches_, tree});
  return tree;
}

ItemBvh::Searched ItemBvh::searched_for(std::size_t place, const DrawItem& item, std::size_t max_triangles) {
  const std::shared_ptr<Tree> tree = tree_of(item.mesh, max_triangles);
  if (!tree) return {};
  Item& known = items_[place];
  if (!tree->ready) return known.tree ? Searched{known.searched.get(), &*known.tree->tree} : Searched{item.mesh.get()};
  if (item.mesh->indices.size() / 3 >= MeshTrees::kLargeMesh) known.searched = item.mesh, known.tree = tree;
  return {item.mesh.get(), &*tree->tree};
}

void ItemBvh::prepare(const RenderList& list) {
  ++searches_;
  for (const DrawItem& item : list.items)
    if (item.mesh && item.mesh->primitive == vrml::Mesh::Primitive::triangles &&
        item.mesh->indices.size() / 3 >= MeshTrees::kLargeMesh)
      (void)tree_of(item.mesh, kMaxTriangles);
}

std::optional<SurfaceHit> ItemBvh::nearest(const RenderList& list, const SightLine& line, std::size_t max_triangles,
                                           Sought sought, float pixel) {
  ++searches_;
  update(list);
  std::optional<SurfaceHit> found;
  const vrml::Mesh* found_in = nullptr;
  glm::dvec3 patch_normal(0);
  std::optional<glm::vec3> patch_color;
  const glm::dvec3 usable = line.origin * 0.0 + line.direction * 0.0;
  if (usable != glm::dvec3(0) || line.direction == glm::dvec3(0)) return found;
  const BoxTree::Walker walker(line);
  tree_.visit(line, [&](std::uint32_t place, double farthest) {
    const DrawItem& item = list.items[place];
    if (!is_sought(item, sought)) return farthest;
    const Box& box = boxes_[place];
    if (box.empty() || !std::isfinite(walker.enter(box.lower, box.upper, farthest))) return farthest;
    const glm::dmat4 node_from_world = glm::inverse(item.world_from_node);
    if (!is_finite(node_from_world)) return farthest;
    Span span{0, farthest};
    if (!item.clip_planes.empty()) span = span_inside(list, item.clip_planes, {line.origin, line.direction, farthest});
    if (span.to < span.from) return farthest;
    const glm::dvec3 start = line.origin + line.direction * span.from;
    const SightLine inside{glm::dvec3(node_from_world * glm::dvec4(start, 1)),
                           glm::dvec3(node_from_world * glm::dvec4(line.direction, 0)), span.to - span.from};
    if (item.patches() && sought != Sought::met) {
      auto hit = pick_patches(*item.patches(), inside, pixel / item.detail);
      if (hit) hit->distance += span.from;
      if (!hit || (found && hit->distance == found->triangle.distance && place > found->item)) return farthest;
      found = SurfaceHit{place, {hit->distance, hit->patch, hit->weights}};
      found_in = nullptr;
      patch_normal = hit->normal;
      patch_color = hit->color;
      return hit->distance;
    }
    const Searched searched = searched_for(place, item, max_triangles);
    if (!searched.mesh) return farthest;
    auto hit = searched.tree ? searched.tree->nearest(*searched.mesh, inside) : nearest_of_all(*searched.mesh, inside);
    if (hit) hit->distance += span.from;
    if (!hit || (found && hit->distance == found->triangle.distance && place > found->item)) return farthest;
    found = SurfaceHit{place, *hit};
    found_in = searched.mesh;
    return hit->distance;
  });
  if (found && found_in) describe(list.items[found->item], *found_in, line, *found);
  if (found && !found_in) {
    found->point = line.origin + line.direction * found->triangle.distance;
    found->normal = world_normal(list.items[found->item], patch_normal);
    found->patch_color = patch_color;
  }
  return found;
}

std::vector<WorldTriangle> ItemBvh::near(const RenderList& list, const glm::dvec3& lower, const glm::dvec3& upper,
                                         std::size_t most) {
  ++searches_;
  update(list);
  std::vector<WorldTriangle> found;
  if (lower * 0.0 + upper * 0.0 != glm::dvec3(0)) return found;
  tree_.visit(lower, upper, [&](std::uint32_t place) {
    const DrawItem& item = list.items[place];
    if (!is_sought(item, Sought::met) || boxes_[place].empty()) return true;
    const glm::dmat4 node_from_world = glm::inverse(item.world_from_node);
    if (!is_finite(node_from_world)) return true;
    const Searched searched = searched_for(place, item, kMaxTriangles);
    if (!searched.mesh) return true;
    const glm::dvec3 center((lower + upper) * 0.5), half((upper - lower) * 0.5);
    const glm::dvec3 inside(node_from_world * glm::dvec4(center, 1));
    glm::dvec3 extent(0);
    for (int i = 0; i < 3; ++i) extent += glm::abs(glm::dvec3(node_from_world[i])) * half[i];
    const vrml::Mesh& mesh = *searched.mesh;
    // Without a tree, skip triangles outside of the box, tested in node space. Most triangles are far away.
    const glm::dvec3 least_inside = inside - extent, greatest_inside = inside + extent;
    const auto is_near = [&](std::uint32_t triangle) {
      const std::uint32_t* corners = mesh.indices.data() + std::size_t{3} * triangle;
      const glm::vec3 &a = mesh.positions[corners[0]], &b = mesh.positions[corners[1]], &c = mesh.positions[corners[2]];
      bool beside = false;
      for (int i = 0; i < 3; ++i)
        beside = beside || (a[i] < least_inside[i] && b[i] < least_inside[i] && c[i] < least_inside[i]) ||
                 (a[i] > greatest_inside[i] && b[i] > greatest_inside[i] && c[i] > greatest_inside[i]);
      return !beside;
    };
    const auto take = [&](std::uint32_t triangle) {
      WorldTriangle met{place, {}};
      glm::dvec3 least(HUGE_VAL), greatest(-HUGE_VAL);
      for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec4 corner(mesh.positions[mesh.indices[std::size_t{3} * triangle + i]], 1);
        met.corners[i] = glm::dvec3(item.world_from_node * corner);
        least = glm::min(least, met.corners[i]);
        greatest = glm::max(greatest, met.corners[i]);
      }
      bool touches = true;  // becomes false if a corner is NaN
      for (int i = 0; i < 3; ++i) touches = touches && least[i] <= upper[i] && greatest[i] >= lower[i];
      if (touches) found.push_back(met);
      return found.size() < most;
    };
    if (searched.tree) {
      searched.tree->near(mesh, inside - extent, inside + extent, take);
    } else {
      for (std::uint32_t i = 0; i < mesh.indices.size() / 3; ++i)
        if (is_near(i) && !take(i)) break;
    }
    return found.size() < most;
  });
  return found;
}

}  // namespace gs::render
