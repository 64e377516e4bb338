#include "app/view/picking.h"

#include "render/rays/mesh_bvh.h"
#include "render/rays/splat_pick.h"

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace gs::app {
namespace {

constexpr float kSolid = 0.5f;  // a volume with at least this opacity hides objects behind it

}  // namespace

const render::VolumeModel& Picker::model_of(const std::shared_ptr<const qnv::Volume>& volume) {
  std::erase_if(models_, [](const auto& entry) { return entry.second.volume.expired(); });
  const auto [found, fresh] = models_.try_emplace(volume.get());
  if (fresh) found->second = {volume, render::volume_model(*volume)};
  return found->second.model;
}

std::optional<Hit> Picker::pick(const render::RenderList& list, const Ray& ray, const PickOptions& options) {
  return pick(list, render::SightLine{ray.origin, glm::dvec3(ray.direction)}, options);
}

std::optional<Hit> Picker::pick(const render::RenderList& list, const render::SightLine& line,
                                const PickOptions& options) {
  std::optional<Hit> nearest, faint;
  const auto surface_hit = [](const render::SurfaceHit& hit) {
    return Hit{static_cast<float>(hit.triangle.distance),
               hit.item,
               std::nullopt,
               hit.point,
               hit.normal,
               hit.texture_coordinate,
               hit.triangle,
               hit.patch_color};
  };
  // Test overlays first, because they are drawn on top of everything.
  if (list.overlays)
    if (const auto hit = items_.nearest(list, options.overlay_line.value_or(line), options.max_triangles,
                                        render::Sought::overlay, options.pixel))
      return surface_hit(*hit);
  if (const auto hit = items_.nearest(list, line, options.max_triangles, render::Sought::seen, options.pixel))
    nearest = surface_hit(*hit);
  const auto splat_hit = [&](float distance, std::size_t splat) {
    return Hit{distance, 0, splat, line.origin + line.direction * double{distance}, -line.direction, {}, {}, {}};
  };
  render::PickRay looking;
  looking.origin = line.origin;
  looking.direction = glm::vec3(line.direction);
  looking.pixel = options.pixel;
  if (nearest) looking.farthest = nearest->distance;
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const render::SplatItem& item = list.splats[i];
    if (!item.geometry) continue;
    if (const auto disc = render::pick_disc(*item.geometry, item.world_from_node, looking)) {
      nearest = splat_hit(disc->distance, i);
      if (disc->color) nearest->stream_color = glm::vec3(disc->color->r, disc->color->g, disc->color->b) / 255.0f;
      looking.farthest = disc->distance;
    }
  }
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const render::SplatItem& item = list.splats[i];
    const auto volume = qnv::shared_as<qnv::Volume>(item.geometry);
    if (!volume || volume->empty()) continue;
    render::VolumeOptions look;
    look.opacity = options.splat_style.opacity * (1 - item.material.transparency);
    look.least_magnitude = options.splat_style.least_magnitude;
    if (options.splat_style.clip) look.clip = glm::vec4(*options.splat_style.clip * item.world_from_node);
    const render::VolumeTransfer transfer = render::volume_transfer(volume->description, options.splat_style.transfer);
    look.transfer = &transfer;
    const auto veil = render::pick_volume(*volume, model_of(volume), look, item.world_from_node, looking);
    if (!veil) continue;
    if (veil->opacity >= kSolid) {
      nearest = splat_hit(veil->distance, i);
      looking.farthest = veil->distance;
    } else if (!faint || veil->distance < faint->distance) {
      faint = splat_hit(veil->distance, i);
    }
  }
  return nearest ? nearest : faint;
}

std::vector<vrml::PathStep> path_of(const render::RenderList& list, const Hit& hit) {
  std::vector<vrml::PathStep> path;
  const auto& places = list.places;
  for (std::uint32_t at = hit.splat ? list.splats[*hit.splat].place : list.items[hit.item].place; at < places.size();
       at = places[at].parent) {
    const render::Place& place = places[at];
    // A step needs the space of the parent's children; for a root, this is world space.
    const bool root = place.parent >= places.size();
    path.push_back({place.scene, place.node, root ? glm::dmat4(1) : list.world_from_frame[places[place.parent].frame]});
  }
  std::reverse(path.begin(), path.end());
  return path;
}

std::vector<SensorGeometry> sensor_geometry(vrml::Execution& world, const render::RenderList& list) {
  std::vector<SensorGeometry> result;
  std::unordered_map<const vrml::Node*, std::size_t> known;
  std::unordered_map<std::uint32_t, std::vector<std::size_t>> of_parent;  // indices in `result`, by the parent's index
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const render::DrawItem& item = list.items[i];
    if (!item.visible || item.place >= list.places.size()) continue;
    // Children of one parent have the same sensors; look them up once.
    const auto [found, fresh] = of_parent.try_emplace(list.places[item.place].parent);
    if (fresh) {
      Hit hit;
      hit.item = i;
      for (const vrml::NodePlace& sensor : world.pointing().sensors_of(path_of(list, hit))) {
        const auto [number, first] = known.try_emplace(&sensor.scene->node(sensor.node), result.size());
        if (first) result.push_back({sensor, {}});
        found->second.push_back(number->second);
      }
    }
    for (const std::size_t number : found->second) result[number].items.push_back(i);
  }
  return result;
}

const std::vector<SensorGeometry>& SensorGeometries::of(vrml::Execution& world, const render::RenderList& list) {
  const bool same = list.generation != 0 && list.generation == generation_ && world_ == &world &&
                    world.pointing().revision() == revision_;
  if (same) return known_;
  known_ = sensor_geometry(world, list);
  world_ = &world;
  generation_ = list.generation;
  revision_ = world.pointing().revision();
  return known_;
}

render::RenderList only(const render::RenderList& list, const std::vector<std::size_t>& items) {
  render::RenderList result;
  result.scenes = list.scenes;
  std::unordered_map<std::uint32_t, std::uint32_t> places;  // new index of a place by its old index
  for (const std::size_t i : items) {
    result.items.push_back(list.items[i]);
    result.overlays = result.overlays || list.items[i].overlay;
    std::uint32_t* from = &result.items.back().place;
    for (std::uint32_t at = *from; at < list.places.size();) {
      const auto [place, fresh] = places.try_emplace(at, static_cast<std::uint32_t>(result.places.size()));
      *from = place->second;
      if (!fresh) break;
      result.places.push_back(list.places[at]);
      render::Place& made = result.places.back();
      result.world_from_frame.push_back(list.world_from_frame[std::exchange(made.frame, place->second)]);
      at = made.parent;
      from = &made.parent;
    }
  }
  return result;
}

std::optional<render::SightLine> line_that_meets(const render::RenderList& list, const glm::dvec3& eye) {
  for (const render::DrawItem& item : list.items) {
    const vrml::Mesh& mesh = *item.mesh;
    if (mesh.primitive != vrml::Mesh::Primitive::triangles || mesh.empty()) continue;
    const auto in_world = [&](const glm::vec3& point) {
      return glm::dvec3(item.world_from_node * glm::dvec4(glm::dvec3(point), 1));
    };
    // Test all triangles, because building a search tree would not pay off for a single query.
    const glm::dmat4 node_from_world = glm::inverse(item.world_from_node);
    const auto meets = [&](const glm::dvec3& point) -> std::optional<render::SightLine> {
      const glm::dvec3 way = point - eye;
      const double length = glm::length(way);
      if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
      const render::SightLine line{eye, way / length};
      const render::SightLine in_node{node_from_world * glm::dvec4(line.origin, 1),
                                      node_from_world * glm::dvec4(line.direction, 0)};
      return render::nearest_of_all(mesh, in_node) ? std::optional(line) : std::nullopt;
    };
    if (const auto line = meets(in_world(mesh.bounds.center()))) return line;
    // Otherwise aim at the triangle with the largest apparent size.
    double largest = 0;
    glm::dvec3 middle(0);
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      const glm::dvec3 a = in_world(mesh.positions[mesh.indices[i]]), b = in_world(mesh.positions[mesh.indices[i + 1]]),
                       c = in_world(mesh.positions[mesh.indices[i + 2]]);
      const glm::dvec3 center = (a + b + c) / 3.0, way = center - eye;
      const double distance = glm::length(way);
      const double seen = std::abs(glm::dot(glm::cross(b - a, c - a), way)) / (distance * distance * distance);
      if (!(seen > largest)) continue;
      largest = seen;
      middle = center;
    }
    if (largest > 0)
      if (const auto line = meets(middle)) return line;
  }
  return std::nullopt;
}

render::SightLine sight_line(const Pose& pose, const glm::dvec2& pointer, const glm::dvec2& size) {
  const double unit = std::max(1.0, std::min(size.x, size.y)) / 2;
  const glm::dvec2 part = (pointer - size * 0.5) / unit;
  if (pose.height > 0) {
    const glm::dvec3 aside(part.x * pose.height / 2, -part.y * pose.height / 2, kParallelReach * pose.height);
    const glm::dquat turn(pose.orientation);
    return {pose.position + turn * aside, glm::normalize(turn * glm::dvec3(0, 0, -1))};
  }
  const glm::dvec2 place = part * std::tan(double{pose.field_of_view} / 2);
  const glm::dvec3 direction = glm::dquat(pose.orientation) * glm::dvec3(place.x, -place.y, -1);
  return {pose.position, glm::normalize(direction)};
}

std::optional<render::SightLine> overlay_line(const Pose& pose, const glm::dvec2& pointer, const glm::dvec2& size) {
  if (!(pose.height > 0)) return std::nullopt;
  Pose perspective = pose;
  perspective.height = 0;
  return sight_line(perspective, pointer, size);
}

std::optional<Hit> point(vrml::Execution& world, Picker& picker, const render::RenderList& list,
                         const render::SightLine& line, bool down, const PickOptions& options) {
  vrml::Pointer pointer;
  pointer.down = down;
  const std::optional<Hit> hit = picker.pick(list, line, options);
  const bool on_overlay = world.pointing().pointed_at().active ? options.holds_overlay
                                                               : hit && !hit->splat && list.items[hit->item].overlay;
  const render::SightLine& used = on_overlay && options.overlay_line ? *options.overlay_line : line;
  pointer.bearing.origin = used.origin;
  pointer.bearing.direction = used.direction;
  std::vector<vrml::PathStep> path;
  if (hit) {
    path = path_of(list, *hit);
    pointer.path = path;
    pointer.bearing.point = hit->point;
    pointer.bearing.normal = hit->normal;
    pointer.bearing.texture_coordinate = glm::dvec2(hit->texture_coordinate);
  }
  world.pointing().point(pointer);
  return hit;
}

}  // namespace gs::app
