#include "app/view/derived/volume_scene.h"

#include "app/view/values/slice_scene.h"
#include "render/volume_rendering/volume_box.h"

#include <utility>

namespace gs::app {
namespace {

bool is_volume_item(const render::SplatItem& item) { return item.geometry && item.geometry->as<qnv::Volume>(); }

}  // namespace

const render::RenderList& VolumeScene::with_content(const render::RenderList& list, const glm::dmat4& world_from_volume,
                                                    const VolumeContent& content) {
  if (!content.any()) return list;
  if (of_ == &list && generation_ == list.generation && changes_ == list.changes &&
      world_from_volume_ == world_from_volume && content_ == content)
    return list_;
  list_ = list;
  list_.generation = 0;
  list_.changes = render::next_change();
  list_.moved.clear();
  if (content.hides_vectors || content.projection) {
    hide_volumes(list_);
  } else if (content.vectors) {
    for (render::SplatItem& item : list_.splats)
      if (is_volume_item(item)) {
        item.geometry = content.vectors;
        break;
      }
  }
  render::ClipList clip;
  if (content.clip && list_.clip_planes.size() < UINT16_MAX) {
    clip.push_back(static_cast<std::uint16_t>(list_.clip_planes.size()));
    list_.clip_planes.push_back(*content.clip);
  }
  if (content.surface) {
    render::DrawItem surface;
    surface.mesh = content.surface;
    surface.world_from_node = world_from_volume;
    surface.material.diffuse = content.surface_color;
    surface.material.specular = glm::vec3(0.12f);
    surface.clip_planes = clip;
    list_.items.push_back(std::move(surface));
  }
  if (content.projection) {
    render::DrawItem projection;
    projection.mesh = render::volume_box();
    projection.world_from_node = world_from_volume * content.projection->volume_from_box;
    projection.material.lit = false;
    projection.volume = content.projection->look;
    projection.clip_planes = clip;
    list_.items.push_back(std::move(projection));
  }
  of_ = &list;
  generation_ = list.generation;
  changes_ = list.changes;
  world_from_volume_ = world_from_volume;
  content_ = content;
  return list_;
}

}  // namespace gs::app
