#include "app/commands/common/picture_world.h"

#include "app/base/numbered_files.h"
#include "app/commands/common/option_groups.h"
#include "app/session/viewports/view.h"

#include <glm/trigonometric.hpp>

namespace gs::app {

render::DrawOptions picture_draw(const PictureOptions& options, const View& seen) {
  render::DrawOptions draw;
  draw.width = options.width;
  draw.height = options.height;
  draw.samples = options.samples;
  draw.headlight = options.headlight.value_or(options.orbit || seen.list->navigation.headlight);
  draw.visibility_limit = !options.orbit;
  draw.unit = static_cast<float>(seen.scale);
  draw.background = options.background;
  draw.display = options.display;
  light_objects(*seen.document, draw);
  draw.backdrop = options.backdrop.value_or(!seen.document->world.authored);
  draw.budget = options.budget;
  draw.splats = options.splats;
  return draw;
}

ViewStyle view_style(const PictureOptions& options) {
  ViewStyle style;
  style.up = options.up.value_or(UpAxis::automatic);
  style.parallel = options.orthographic;
  style.display = options.display;
  constexpr double kPointsPerInch = 72;
  if (options.picture.dots_per_inch > 0) style.pixels_per_point = options.picture.dots_per_inch / kPointsPerInch;
  return style;
}

std::optional<std::string> check_camera(const PictureOptions& options) {
  if (options.camera && (options.orbit || !options.viewpoint.empty()))
    return "--camera, --orbit and --viewpoint exclude each other; expected one of them";
  return std::nullopt;
}

std::optional<render::Camera> camera_of_options(const PictureOptions& options, const render::RenderList& list) {
  if (options.camera) {
    if (!options.orthographic || options.camera->height > 0) return camera_of(*options.camera);
    const glm::dvec3 center(list.bounds.empty() ? glm::dvec3(0) : list.bounds.center());
    const double ahead = glm::dot(center - options.camera->position, glm::dvec3(options.camera->forward()));
    return camera_of(with_parallel_rays(*options.camera, true, ahead > 0 ? ahead : 10));
  }
  if (!options.orbit) return std::nullopt;
  constexpr float kFieldOfView = 0.785398f;
  const glm::vec2 size(options.width, options.height);
  render::Camera camera = orbit_camera_of(list.bounds, glm::radians(static_cast<float>(options.orbit->first)),
                                          glm::radians(static_cast<float>(options.orbit->second)), kFieldOfView, size,
                                          upright_of(options.up.value_or(UpAxis::automatic)));
  if (options.orthographic) camera.height = fitting_height(camera, list.bounds, size);
  return camera;
}

std::optional<std::string> settle_size(PictureOptions& options) {
  if (!options.paper) return std::nullopt;
  options.picture.paper = options.paper;
  const auto pixels = pixels_of(options.picture);
  if (!pixels) return "--size with this --dpi is out of range; expected 1 to 65536 pixels per side";
  options.width = pixels->x;
  options.height = pixels->y;
  if (options.picture.dots_per_inch == 0) options.picture.dots_per_inch = kUsualDots;
  return std::nullopt;
}

std::optional<std::string> settle_series(const PictureOptions& options, double time, std::string& path) {
  const auto files = file_series(path);
  if (!files) return std::nullopt;
  if (files->empty()) return path + ": no file of this series exists";
  path = (*files)[series_place(time, options.animation.rate, files->size())];
  return std::nullopt;
}

}  // namespace gs::app
