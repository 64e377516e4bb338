#include "app/view/picking.h"

#include "render/rays/splat_pick.h"

#include <glm/mat4x4.hpp>

namespace gs::app {
namespace {

constexpr float kSolid = 0.5f;  // opacity from which a volume hides what lies behind it

}  // namespace

const render::VolumeModel& Picker::model_of(const std::shared_ptr<const qnv::Cloud>& cloud) {
  std::erase_if(models_, [](const auto& entry) { return entry.second.cloud.expired(); });
  const auto [found, fresh] = models_.try_emplace(cloud.get());
  if (fresh) found->second = {cloud, render::volume_model(*cloud)};
  return found->second.model;
}

std::optional<Hit> Picker::pick(const render::RenderList& list, const Ray& ray, const PickOptions& options) {
  return pick(list, render::SightLine{glm::dvec3(ray.origin), glm::dvec3(ray.direction)}, options);
}

std::optional<Hit> Picker::pick(const render::RenderList& list, const render::SightLine& line,
                                const PickOptions& options) {
  std::optional<Hit> nearest, faint;
  if (const auto hit = items_.nearest(list, line, options.max_triangles))
    nearest = Hit{static_cast<float>(hit->triangle.distance),
                  hit->item,
                  std::nullopt,
                  hit->point,
                  hit->normal,
                  hit->texture_coordinate};
  const auto splat_hit = [&](float distance, std::size_t splat) {
    return Hit{distance, 0, splat, line.origin + line.direction * double{distance}, -line.direction, {}};
  };
  render::PickRay looking;
  looking.origin = glm::vec3(line.origin);
  looking.direction = glm::vec3(line.direction);
  looking.pixel = options.pixel;
  if (nearest) looking.farthest = nearest->distance;
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const render::SplatItem& item = list.splats[i];
    if (!item.cloud || item.cloud->description.kind != qnv::Kind::surface) continue;
    if (const auto distance = render::pick_surface(*item.cloud, item.world_from_node, looking)) {
      nearest = splat_hit(*distance, i);
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
      nearest = splat_hit(veil->distance, i);
      looking.farthest = veil->distance;
    } else if (!faint || veil->distance < faint->distance) {
      faint = splat_hit(veil->distance, i);
    }
  }
  return nearest ? nearest : faint;
}

std::optional<Hit> pick(const render::RenderList& list, const Ray& ray, const PickOptions& options) {
  return Picker().pick(list, ray, options);
}

}  // namespace gs::app
