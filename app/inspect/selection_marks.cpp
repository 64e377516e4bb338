#include "app/inspect/selection_marks.h"

#include "render/collection/collector.h"

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

using WideLine = std::pair<glm::dvec3, glm::dvec3>;

/// Projects lines into a viewport. Clips them at a near plane in front of the viewer.
std::vector<PixelLine> projected(std::span<const WideLine> lines, const Pose& pose, const Viewport& viewport,
                                 const glm::dmat4& world_from_lines) {
  const glm::dquat viewer_from_world = glm::conjugate(glm::dquat(pose.orientation));
  const auto seen = [&](const glm::dvec3& point) {
    return viewer_from_world * (glm::dvec3(world_from_lines * glm::dvec4(point, 1)) - pose.position);
  };
  double size = 0;
  for (const auto& [a, b] : lines) size = std::max({size, glm::length(seen(a)), glm::length(seen(b))});
  // VRML97 applies the field of view to the smaller side of the picture.
  const double smaller = std::max(1, std::min(viewport.width, viewport.height));
  const double pixels = smaller / (2 * std::tan(double{pose.field_of_view} / 2));
  const double near = std::max(1e-4 * size, 1e-9);
  const auto pixel_of = [&](const glm::dvec3& point) {
    if (pose.height > 0)
      return glm::vec2(viewport.left + viewport.width * 0.5 + point.x * smaller / pose.height,
                       viewport.top + viewport.height * 0.5 - point.y * smaller / pose.height);
    return glm::vec2(viewport.left + viewport.width * 0.5 - point.x / point.z * pixels,
                     viewport.top + viewport.height * 0.5 + point.y / point.z * pixels);
  };
  std::vector<PixelLine> result;
  for (const auto& [from, to] : lines) {
    glm::dvec3 a = seen(from), b = seen(to);
    if (pose.height <= 0) {
      if (a.z > -near && b.z > -near) continue;
      if (a.z > -near) a += (b - a) * ((-near - a.z) / (b.z - a.z));
      if (b.z > -near) b += (a - b) * ((-near - b.z) / (a.z - b.z));
    }
    result.emplace_back(pixel_of(a), pixel_of(b));
  }
  return result;
}

}  // namespace

WideBox bounds_in(const render::RenderList& list, std::span<const NodeAt> nodes) {
  // The nodes of a PROTO body are drawn instead of the PROTO instance.
  std::vector<NodeAt> drawn;
  for (const NodeAt& node : nodes)
    drawn.push_back(
        {node.scene, node && node.scene->contains(node.id) ? node.scene->resolve(node.id) : vrml::NodeId{}});
  const auto rank_of = [&](const render::Place& place) {
    return static_cast<std::size_t>(std::find(drawn.begin(), drawn.end(), NodeAt{place.scene, place.node}) -
                                    drawn.begin());
  };
  std::size_t best = drawn.size();
  for (const render::Place& place : list.places) best = std::min(best, rank_of(place));
  WideBox bounds;
  if (best == drawn.size()) return bounds;
  std::vector<bool> inside(list.places.size());
  for (std::size_t i = 0; i < list.places.size(); ++i) {
    const render::Place& place = list.places[i];
    inside[i] = (place.parent < i && inside[place.parent]) || rank_of(place) == best;
  }
  const auto add = [&](const WideBox& one) { bounds.add(one); };
  for (const render::DrawItem& item : list.items)
    if (item.place < inside.size() && inside[item.place] && item.mesh && item.visible)
      add(render::world_bounds(item.mesh->bounds, item.world_from_node));
  for (const render::SplatItem& splat : list.splats)
    if (splat.place < inside.size() && inside[splat.place] && splat.geometry) {
      const Box& box = splat.geometry->description().box;
      add(render::world_bounds({box.lower, box.upper}, splat.world_from_node));
    }
  return bounds;
}

std::vector<PixelLine> edges_of(const WideBox& box, const Pose& pose, const Viewport& viewport,
                                const glm::dmat4& world_from_box) {
  if (box.empty()) return {};
  std::vector<WideLine> lines;
  const auto corner = [&](unsigned i) {
    return glm::dvec3((i & 1) != 0 ? box.upper.x : box.lower.x, (i & 2) != 0 ? box.upper.y : box.lower.y,
                      (i & 4) != 0 ? box.upper.z : box.lower.z);
  };
  for (unsigned i = 0; i < 8; ++i)
    for (const unsigned side : {1U, 2U, 4U})
      if ((i & side) == 0) lines.emplace_back(corner(i), corner(i | side));
  return projected(lines, pose, viewport, world_from_box);
}

std::vector<PixelLine> circles_of(const glm::dvec3& center, double radius, const Pose& pose, const Viewport& viewport,
                                  const glm::dmat4& world_from_sphere) {
  constexpr int kSteps = 48;
  std::vector<WideLine> lines;
  for (int axis = 0; axis < 3; ++axis) {
    const auto point = [&](int step) {
      const double angle = 2 * std::numbers::pi * step / kSteps;
      glm::dvec3 from_center(0);
      from_center[(axis + 1) % 3] = radius * std::cos(angle);
      from_center[(axis + 2) % 3] = radius * std::sin(angle);
      return center + from_center;
    };
    for (int step = 0; step < kSteps; ++step) lines.emplace_back(point(step), point(step + 1));
  }
  return projected(lines, pose, viewport, world_from_sphere);
}

void SelectionMark::find_bounds(const NodeAt& node, const SceneIndex& index, const View& view, double now) {
  if (node_ == node && now < due_) return;
  const auto begin = world_time();
  node_ = node;
  std::vector<NodeAt> nodes{node};
  const std::vector<HeldStep> way = index.way_to(node);
  for (auto step = way.rbegin(); step != way.rend(); ++step)
    if (!(step->node == node)) nodes.push_back(step->node);
  bounds_ = bounds_in(*view.list, nodes);
  // In large worlds, the search takes long. Limit its share of the time to 1 / kShare.
  constexpr double kShare = 30;
  due_ = now + kShare * (world_time() - begin);
}

}  // namespace gs::app
