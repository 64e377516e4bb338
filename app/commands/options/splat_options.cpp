#include "app/commands/options/splat_options.h"

#include "app/commands/options/option_values.h"
#include "app/commands/options/setters.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <tuple>

namespace gs::app {
namespace {

template <bool removes>
Problem add_box(SplatEditOptions& options, const std::string& value) {
  std::array<double, 6> numbers{};
  if (!read_list(value, ',', numbers)) return "expected two corners X,Y,Z,X,Y,Z";
  SplatBox box;
  for (int k = 0; k < 3; ++k) {
    const auto first = static_cast<std::size_t>(k);
    std::tie(box.lower[k], box.upper[k]) = std::minmax(numbers[first], numbers[first + 3]);
  }
  options.splats.crops.push_back({box, removes});
  return {};
}

template <bool removes>
Problem add_sphere(SplatEditOptions& options, const std::string& value) {
  std::array<double, 4> numbers{};
  if (!read_list(value, ',', numbers) || !(numbers[3] > 0)) return "expected X,Y,Z,RADIUS with a radius above 0";
  options.splats.crops.push_back({SplatBall{{numbers[0], numbers[1], numbers[2]}, numbers[3]}, removes});
  return {};
}

Problem set_min_opacity(SplatEditOptions& options, const std::string& value) {
  return read_share(value, options.splats.least_opacity) ? Problem{}
                                                         : "expected an opacity from 0 to 1, or a percentage";
}

Problem set_max_splat_size(SplatEditOptions& options, const std::string& value) {
  double& size = options.splats.most_size;
  return read(value, size) && std::isfinite(size) && size > 0 ? Problem{} : "expected a length above 0";
}

Problem set_move(SplatEditOptions& options, const std::string& value) {
  std::array<double, 3> numbers{};
  if (!read_list(value, ',', numbers)) return "expected X,Y,Z";
  options.splats.move = {numbers[0], numbers[1], numbers[2]};
  return {};
}

Problem set_turn(SplatEditOptions& options, const std::string& value) {
  std::array<double, 3> numbers{};
  if (!read_list(value, ',', numbers)) return "expected angles X,Y,Z in degrees";
  options.splats.turn = {numbers[0], numbers[1], numbers[2]};
  return {};
}

Problem set_scale(SplatEditOptions& options, const std::string& value) {
  double& scale = options.splats.scale;
  constexpr double kMost = SplatEdit::kMostScale;
  return read(value, scale) && scale >= 1 / kMost && scale <= kMost ? Problem{}
                                                                    : "expected a factor from 0.000001 to 1000000";
}

Problem set_exposure(SplatEditOptions& options, const std::string& value) {
  double& exposure = options.splats.exposure;
  constexpr double kMost = SplatEdit::kMostExposure;
  return read(value, exposure) && exposure >= -kMost && exposure <= kMost ? Problem{} : "expected -16 to 16 stops";
}

constexpr OptionRow kSplatOptions[] = {
    {"--crop-box", "X,Y,Z,X,Y,Z", "",
     "Gaussian splats: keep those with centres in the box between two corners; repeat it, or add --crop-sphere, to "
     "keep those in any of the regions",
     "encode export ", with<add_box<false>>, true},
    {"--crop-sphere", "X,Y,Z,RADIUS", "", "Gaussian splats: keep those with centres in the sphere, like --crop-box",
     "encode export ", with<add_sphere<false>>, true},
    {"--remove-box", "X,Y,Z,X,Y,Z", "",
     "Gaussian splats: remove those with centres in the box, also from regions to keep; may be repeated",
     "encode export ", with<add_box<true>>, true},
    {"--remove-sphere", "X,Y,Z,RADIUS", "",
     "Gaussian splats: remove those with centres in the sphere, also from regions to keep; may be repeated",
     "encode export ", with<add_sphere<true>>, true},
    {"--min-opacity", "SHARE", "0", "Gaussian splats: remove fainter ones (0 to 1, or 5%)", "encode export ",
     with<set_min_opacity>},
    {"--max-splat-size", "LENGTH", "", "Gaussian splats: remove those with a longer standard deviation",
     "encode export ", with<set_max_splat_size>},
    {"--scale", "FACTOR", "1", "Gaussian splats: scale about the point 0,0,0", "encode export ", with<set_scale>},
    {"--turn", "X,Y,Z", "0,0,0",
     "Gaussian splats: turn about the axes X, Y and Z through 0,0,0, in this order, by degrees", "encode export ",
     with<set_turn>},
    {"--move", "X,Y,Z", "0,0,0", "Gaussian splats: move, after scaling and turning", "encode export ", with<set_move>},
    {"--exposure", "STOPS", "0", "Gaussian splats: make brighter (1 doubles the light) or darker (-1 halves it)",
     "encode export ", with<set_exposure>},
};

}  // namespace

std::span<const OptionRow> splat_option_rows() { return kSplatOptions; }

}  // namespace gs::app
