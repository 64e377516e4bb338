#include "app/commands/picture_world.h"

#include "app/base/numbered_files.h"
#include "app/commands/commands.h"

namespace gs::app {

render::DrawOptions picture_draw(const Options& options, const View& seen) {
  render::DrawOptions draw;
  draw.width = options.width;
  draw.height = options.height;
  draw.samples = options.samples;
  draw.headlight = options.headlight.value_or(options.orbit || seen.list->navigation.headlight);
  draw.visibility_limit = !options.orbit;
  draw.unit = static_cast<float>(seen.scale);
  draw.background = options.background;
  draw.budget = options.budget;
  draw.splats = splat_path(options.splats);
  return draw;
}

std::optional<std::string> settle_size(Options& options) {
  if (!options.picture.paper) return std::nullopt;
  const auto pixels = pixels_of(options.picture);
  if (!pixels) return "--size with this --dpi is more than 65536 pixels a side, or none";
  options.width = pixels->x;
  options.height = pixels->y;
  if (options.picture.dots_per_inch == 0) options.picture.dots_per_inch = kUsualDots;
  return std::nullopt;
}

std::optional<std::string> settle_series(const Options& options, double time, std::string& path) {
  const auto files = file_series(path);
  if (!files) return std::nullopt;
  if (files->empty()) return path + ": there is no file of this series";
  path = (*files)[series_place(time, options.animation.rate, files->size())];
  return std::nullopt;
}

VolumeWishes volume_wishes(const Options& options) {
  return {options.transfer, options.slices, options.slice_look, options.picture.color_bar};
}

}  // namespace gs::app
