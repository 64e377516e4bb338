#include "app/view/picking.h"

#include "render/rays/splat_pick.h"

#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

constexpr float kSolid = 0.5f;  // opacity from which a volume hides what lies behind it

/// Distance at which the line enters the box, in lengths of `direction`; none when it misses.
std::optional<float> enter(const vrml::Bounds& box, const glm::vec3& origin, const glm::vec3& direction) {
  float first = 0, last = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) {
      if (!(origin[axis] >= box.lower[axis] && origin[axis] <= box.upper[axis])) return std::nullopt;
      continue;
    }
    float a = (box.lower[axis] - origin[axis]) / direction[axis];
    float b = (box.upper[axis] - origin[axis]) / direction[axis];
    if (a > b) std::swap(a, b);
    first = std::max(first, a);
    last = std::min(last, b);
  }
  // A flat box is entered and left at once, which rounding may turn round.
  if (!(first <= last + 1e-4f * std::max(1.0f, std::abs(last)))) return std::nullopt;
  return first;
}

/// Moeller and Trumbore: distance in lengths of `direction`.
std::optional<float> meet(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c, const glm::vec3& origin,
                          const glm::vec3& direction) {
  const glm::vec3 ab = b - a, ac = c - a;
  const glm::vec3 p = glm::cross(direction, ac);
  const float determinant = glm::dot(ab, p);
  if (determinant == 0) return std::nullopt;
  const glm::vec3 s = origin - a;
  const float u = glm::dot(s, p) / determinant;
  if (!(u >= 0 && u <= 1)) return std::nullopt;
  const glm::vec3 q = glm::cross(s, ab);
  const float v = glm::dot(direction, q) / determinant;
  if (!(v >= 0 && u + v <= 1)) return std::nullopt;
  const float t = glm::dot(ac, q) / determinant;
  return t > 0 && std::isfinite(t) ? std::optional(t) : std::nullopt;
}

/// The nearest triangle.
std::optional<Hit> pick_triangle(const render::RenderList& list, const Ray& ray, std::size_t max_triangles) {
  struct Candidate {
    float enters;
    std::size_t item;
    glm::vec3 origin, direction;  // in node space; one length of direction is one metre of the world
  };
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const render::DrawItem& item = list.items[i];
    if (!item.mesh || item.mesh->primitive != vrml::Mesh::Primitive::triangles || item.mesh->empty()) continue;
    const glm::mat4 node_from_world = glm::inverse(item.world_from_node);
    const glm::vec3 origin(node_from_world * glm::vec4(ray.origin, 1));
    const glm::vec3 direction(node_from_world * glm::vec4(ray.direction, 0));
    if (const auto enters = enter(item.mesh->bounds, origin, direction); enters && std::isfinite(*enters))
      candidates.push_back({*enters, i, origin, direction});
  }
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.enters < b.enters; });
  std::optional<Hit> nearest;
  for (const Candidate& candidate : candidates) {
    if (nearest && candidate.enters > nearest->distance) break;
    const vrml::Mesh& mesh = *list.items[candidate.item].mesh;
    const glm::vec3* positions = mesh.positions.data();
    const std::uint32_t* indices = mesh.indices.data();
    const std::size_t triangles = mesh.indices.size() / 3;
    if (triangles > max_triangles) break;
    max_triangles -= triangles;
    for (std::size_t t = 0; t < triangles; ++t) {
      const auto distance = meet(positions[indices[3 * t]], positions[indices[3 * t + 1]],
                                 positions[indices[3 * t + 2]], candidate.origin, candidate.direction);
      if (distance && (!nearest || *distance < nearest->distance))
        nearest = Hit{*distance, candidate.item, std::nullopt};
    }
  }
  return nearest;
}

}  // namespace

const render::VolumeModel& Picker::model_of(const std::shared_ptr<const qnv::Cloud>& cloud) {
  std::erase_if(models_, [](const auto& entry) { return entry.second.cloud.expired(); });
  const auto [found, fresh] = models_.try_emplace(cloud.get());
  if (fresh) found->second = {cloud, render::volume_model(*cloud)};
  return found->second.model;
}

std::optional<Hit> Picker::pick(const render::RenderList& list, const Ray& ray, const PickOptions& options) {
  std::optional<Hit> nearest = pick_triangle(list, ray, options.max_triangles), faint;
  render::PickRay looking;
  looking.origin = ray.origin;
  looking.direction = ray.direction;
  looking.pixel = options.pixel;
  if (nearest) looking.farthest = nearest->distance;
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const render::SplatItem& item = list.splats[i];
    if (!item.cloud || item.cloud->description.kind != qnv::Kind::surface) continue;
    if (const auto distance = render::pick_surface(*item.cloud, item.world_from_node, looking)) {
      nearest = Hit{*distance, 0, i};
      looking.farthest = *distance;
    }
  }
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const render::SplatItem& item = list.splats[i];
    if (!item.cloud || item.cloud->description.kind != qnv::Kind::volume || item.cloud->empty()) continue;
    render::VolumeOptions look;
    look.opacity = options.clouds.opacity * (1 - item.material.transparency);
    look.least_magnitude = options.clouds.least_magnitude;
    if (options.clouds.clip) look.clip = *options.clouds.clip * item.world_from_node;
    const render::VolumeTransfer transfer = render::volume_transfer(item.cloud->description, options.clouds.transfer);
    look.transfer = &transfer;
    const auto veil = render::pick_volume(*item.cloud, model_of(item.cloud), look, item.world_from_node, looking);
    if (!veil) continue;
    if (veil->opacity >= kSolid) {
      nearest = Hit{veil->distance, 0, i};
      looking.farthest = veil->distance;
    } else if (!faint || veil->distance < faint->distance) {
      faint = Hit{veil->distance, 0, i};
    }
  }
  return nearest ? nearest : faint;
}

std::optional<Hit> pick(const render::RenderList& list, const Ray& ray, const PickOptions& options) {
  return Picker().pick(list, ray, options);
}

}  // namespace gs::app
