#include "app/viewer/start_page.h"

#include "app/interface/base/start_layout.h"
#include "app/desktop/hand_over.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

/// Returns a square of side 1 around the origin, in the plane z = 0.
std::shared_ptr<const vrml::Mesh> unit_square() {
  auto mesh = std::make_shared<vrml::Mesh>();
  for (const auto& [x, y] : {std::pair{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}}) {
    mesh->positions.push_back({x, y, 0});
    mesh->normals.push_back({0, 0, 1});
    mesh->texture_coordinates.push_back({x + 0.5f, y + 0.5f});
    mesh->bounds.add({x, y, 0});
  }
  mesh->indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

}  // namespace

StartPage::StartPage(const std::string& state_folder)
    : thumbnails_(state_folder.empty() ? std::string() : state_folder + "/thumbnails"), square_(unit_square()) {}

void StartPage::set_recent(const std::vector<std::string>& places, float scale) {
  scale_ = scale;
  if (places == recent_) return;
  recent_ = places;
  thumbnails_.keep_only(places);
}

bool StartPage::wants(const View& view, bool rests, double now) {
  constexpr double kSettled = 3;  // seconds
  if (!view.document) return false;
  if (shown_.lock() != view.document) {
    shown_ = view.document;
    shown_since_ = now;
    kept_ = false;
  }
  if (kept_ || !(rests || now - shown_since_ > kSettled)) return false;
  return std::find(recent_.begin(), recent_.end(), absolute_place(view.document->world.path)) != recent_.end();
}

void StartPage::keep(const View& view, const std::vector<std::byte>& png) {
  kept_ = true;
  thumbnails_.keep(absolute_place(view.document->world.path), png);
}

render::FrameStatistics StartPage::draw(render::Renderer& renderer, const Viewport& place,
                                        const render::DrawOptions& draw) {
  render::RenderList list;
  const StartLayout layout = start_layout(place, recent_.size(), scale_);
  for (std::size_t i = 0; i < layout.thumbnails.size(); ++i) {
    const Viewport& at = layout.thumbnails[i];
    render::DrawItem item;
    item.texture.image = thumbnails_.find(recent_[i]);
    if (!item.texture.image) continue;
    item.mesh = square_;
    item.material.lit = false;
    item.material.diffuse = glm::vec3(1);
    item.world_from_node[0].x = at.width;
    item.world_from_node[1].y = at.height;
    // One world unit is a pixel; the centre of the viewport is the origin.
    item.world_from_node[3].x = at.left + at.width / 2.0 - (place.left + place.width / 2.0);
    item.world_from_node[3].y = place.top + place.height / 2.0 - (at.top + at.height / 2.0);
    const glm::vec3 center(item.world_from_node[3]), half(at.width / 2.0f, at.height / 2.0f, 0);
    list.bounds.add(center - half);
    list.bounds.add(center + half);
    list.items.push_back(std::move(item));
  }
  render::Camera camera;
  camera.height = std::min(place.width, place.height);
  camera.world_from_camera[3].z = camera.height;
  return renderer.draw(list, camera, draw);
}

}  // namespace gs::app
