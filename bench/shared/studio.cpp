#include "bench/shared/studio.h"

#include "render/scene/camera.h"
#include "render/scene/surface_mesh.h"

#include <glm/trigonometric.hpp>

#include <utility>
#include <variant>

namespace gs::bench {

Studio::Studio() {
  auto opened = render::open_headless_context("auto");
  if (auto* context = std::get_if<std::unique_ptr<render::GlContext>>(&opened)) context_ = std::move(*context);
  if (!context_) return;
  auto created = render::Renderer::create(*context_);
  if (auto* renderer = std::get_if<std::unique_ptr<render::Renderer>>(&created)) renderer_ = std::move(*renderer);
}

std::vector<render::Image> Studio::pictures(const render::RenderList& list, const WideBox& bounds,
                                            std::span<const View> views) {
  constexpr float kFieldOfView = 0.785398f;
  std::vector<render::Image> out;
  render::DrawOptions draw;
  draw.width = kWidth;
  draw.height = kHeight;
  draw.background = glm::vec3(0);
  for (const View& view : views) {
    const render::Camera camera =
        render::fit_depth(render::orbit_camera(bounds, glm::radians(view.azimuth), glm::radians(view.elevation),
                                               kFieldOfView, kWidth, kHeight),
                          bounds);
    auto drawn = renderer_->draw_to_image(list, camera, draw);
    if (auto* image = std::get_if<render::Image>(&drawn)) out.push_back(std::move(*image));
  }
  return out;
}

render::RenderList list_of(qnv::Geometry geometry) {
  render::RenderList list;
  const auto shared = std::make_shared<const qnv::Geometry>(std::move(geometry));
  if (const auto* mesh = shared->as<qnv::IndexedMesh>()) {
    const auto add = [&](bool pictured) {
      render::DrawItem item;
      item.mesh = render::mesh_of_surface(*shared, pictured);
      item.material.lit = false;
      item.surface = shared;
      render::dress_surface(item);
      if (pictured && mesh->picture) {
        auto decoded = render::decode_image(mesh->picture->bytes);
        if (auto* image = std::get_if<render::Image>(&decoded))
          item.texture = {std::make_shared<const render::Image>(std::move(*image)), mesh->picture->repeat_s,
                          mesh->picture->repeat_t};
      }
      list.items.push_back(std::move(item));
    };
    if (mesh->first_textured() > 0) add(false);
    if (!mesh->texture_coordinates.empty()) add(true);
    return list;
  }
  render::SplatItem item;
  item.geometry = shared;
  item.own_color = true;
  list.splats.push_back(std::move(item));
  return list;
}

}  // namespace gs::bench
