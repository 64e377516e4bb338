#include "app/picture/paint.h"

#include <utility>

namespace gs::app {
namespace {

render::PictureOptions options_of(const PictureScene& scene, const PictureRequest& request) {
  render::PictureOptions options;
  options.draw = scene.draw;
  options.transparent = request.transparent;
  options.stereo = request.stereo;
  options.eye_distance = request.eye_distance * scene.unit;
  return options;
}

/// Renders the picture in bands of rows, draws the overlay over each band, and passes the band to `take`. Returns an
/// error message on failure.
std::optional<std::string> paint(render::Renderer& renderer, const PictureScene& scene, const PictureRequest& request,
                                 render::FrameStatistics* statistics, const std::function<bool(render::Image&)>& take) {
  int top = 0;
  const glm::ivec2 size(scene.draw.width, scene.draw.height);
  const auto problem = render::draw_picture(
      renderer, *scene.list, scene.camera, options_of(scene, request),
      [&](render::Image& band) {
        const int rows = static_cast<int>(band.height);
        if (scene.over) scene.over(band, top, size);
        top += rows;
        return take(band);
      },
      statistics);
  return problem ? std::optional(problem->message) : std::nullopt;
}

}  // namespace

std::variant<std::vector<std::byte>, std::string> paint_png(render::Renderer& renderer, const PictureScene& scene,
                                                            const PictureRequest& request,
                                                            render::FrameStatistics* statistics,
                                                            const std::function<bool(double part)>& go_on) {
  render::PngWriter writer(static_cast<std::uint32_t>(scene.draw.width), static_cast<std::uint32_t>(scene.draw.height),
                           request.transparent ? 4 : 3, request.dots_per_inch);
  double rows = 0;
  auto problem = paint(renderer, scene, request, statistics, [&](const render::Image& band) {
    const PhaseScope phase(scene.phases, Phase::write);
    writer.add(band);
    rows += band.height;
    return !go_on || go_on(rows / scene.draw.height);
  });
  if (problem) return std::move(*problem);
  return writer.finish();
}

std::variant<render::Image, std::string> paint_image(render::Renderer& renderer, const PictureScene& scene,
                                                     const PictureRequest& request) {
  render::Image all{static_cast<std::uint32_t>(scene.draw.width),
                    static_cast<std::uint32_t>(scene.draw.height),
                    request.transparent ? 4u : 3u,
                    {}};
  auto problem = paint(renderer, scene, request, nullptr, [&](render::Image& band) {
    if (all.pixels.empty()) {
      all.pixels = std::move(band.pixels);
    } else {
      all.pixels.insert(all.pixels.end(), band.pixels.begin(), band.pixels.end());
    }
    return true;
  });
  if (problem) return std::move(*problem);
  return all;
}

}  // namespace gs::app
