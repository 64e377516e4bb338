#include "app/view/derived/overlay_scene.h"

namespace gs::app {
namespace {

/// Returns indices in lists that were appended to others.
Array<std::uint16_t> moved_by(const Array<std::uint16_t>& indices, std::size_t offset) {
  Array<std::uint16_t> moved;
  for (const std::uint16_t index : indices)
    if (index + offset <= UINT16_MAX) moved.push_back(static_cast<std::uint16_t>(index + offset));
  return moved;
}

}  // namespace

const render::RenderList& OverlayScene::with(const render::RenderList& list,
                                             std::span<const render::RenderList* const> others) {
  if (others.empty()) return list;
  std::vector<Version> of{version_of(list)};
  for (const render::RenderList* const other : others) of.push_back(version_of(*other));
  if (of == of_) return list_;
  of_ = std::move(of);
  list_ = list;
  list_.generation = 0;
  list_.changes = render::next_change();
  list_.moved.clear();
  for (const render::RenderList* const other : others) {
    const std::size_t lights = list_.lights.size(), planes = list_.clip_planes.size();
    list_.lights.insert(list_.lights.end(), other->lights.begin(), other->lights.end());
    list_.clip_planes.insert(list_.clip_planes.end(), other->clip_planes.begin(), other->clip_planes.end());
    for (const render::DrawItem& one : other->items) {
      render::DrawItem item = one;
      item.directional_lights = moved_by(one.directional_lights, lights);
      item.clip_planes = moved_by(one.clip_planes, planes);
      item.local_fog = render::kNoLocalFog;
      item.place = render::kNoPlace;
      item.collidable = item.touchable = false;
      list_.items.push_back(std::move(item));
    }
    for (const render::SplatItem& one : other->splats) {
      render::SplatItem item = one;
      item.directional_lights = moved_by(one.directional_lights, lights);
      item.clip_planes = moved_by(one.clip_planes, planes);
      item.place = render::kNoPlace;
      list_.splats.push_back(std::move(item));
    }
    list_.bounds.add(other->bounds);
  }
  return list_;
}

}  // namespace gs::app
