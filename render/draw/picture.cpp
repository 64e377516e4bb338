#include "render/draw/picture.h"

#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

namespace gs::render {
namespace {

// Maximum pixels of a tile. Each pixel takes about 64 bytes for samples, depths and splats.
constexpr std::size_t kMaxPartPixels = std::size_t{1} << 24;
constexpr int kPictureTile = 2048;
constexpr int kTileBorder =
    32;  // width in pixels of the margin around a tile; wider than lines, points and pinhole closing

struct TilePlace {
  int x = 0, y = 0, width = 0, height = 0;  // pixels from the upper left corner of the whole image
};

Image cut_out(const Image& from, const TilePlace& place) {
  Image result{static_cast<std::uint32_t>(place.width), static_cast<std::uint32_t>(place.height), from.components, {}};
  const std::size_t row = std::size_t{result.width} * from.components;
  result.pixels.resize(row * result.height);
  for (std::size_t y = 0; y < result.height; ++y)
    std::memcpy(result.pixels.data() + y * row,
                from.pixels.data() +
                    ((y + static_cast<std::size_t>(place.y)) * from.width + static_cast<std::size_t>(place.x)) *
                        from.components,
                row);
  return result;
}

void paste(const Image& what, int left, Image& into) {
  const std::size_t row = std::size_t{what.width} * what.components;
  for (std::size_t y = 0; y < what.height; ++y)
    std::memcpy(into.pixels.data() + (y * into.width + static_cast<std::size_t>(left)) * into.components,
                what.pixels.data() + y * row, row);
}

/// Draws the tiles of one image.
class PartPainter {
 public:
  PartPainter(Renderer& renderer, const RenderList& list, const PictureOptions& options, FrameStatistics* statistics)
      : renderer_(renderer), list_(list), options_(options), statistics_(statistics) {}

  /// Draws a tile. `width` and `height` are the size of the whole image, which `camera` sees.
  std::variant<Image, ContextError> draw(const Camera& camera, int width, int height, const TilePlace& place) {
    if (!options_.transparent) return draw_on(camera, width, height, place, options_.draw.background);
    auto black = draw_on(camera, width, height, place, glm::vec3(0));
    if (std::holds_alternative<ContextError>(black)) return black;
    auto white = draw_on(camera, width, height, place, glm::vec3(1));
    if (std::holds_alternative<ContextError>(white)) return white;
    return without_background(std::get<Image>(black), std::get<Image>(white));
  }

 private:
  std::variant<Image, ContextError> draw_on(Camera camera, int width, int height, const TilePlace& place,
                                            const std::optional<glm::vec3>& background) {
    const bool whole = place.width == width && place.height == height;
    const int border = whole ? 0 : kTileBorder;
    DrawOptions draw = options_.draw;
    draw.background = background;
    draw.width = place.width + 2 * border;
    draw.height = place.height + 2 * border;
    if (!whole) {
      const auto at = [](int pixel, int size) { return -1 + 2 * static_cast<double>(pixel) / size; };
      camera.part = {at(place.x - border, width), -at(place.y + place.height + border, height),
                     at(place.x + place.width + border, width), -at(place.y - border, height)};
    }
    FrameStatistics drawn;
    auto made = renderer_.draw_to_image(list_, camera, draw, &drawn);
    if (statistics_) add(drawn);
    if (whole || std::holds_alternative<ContextError>(made)) return made;
    return cut_out(std::get<Image>(made), {border, border, place.width, place.height});
  }

  void add(const FrameStatistics& drawn) {
    statistics_->triangles = std::max(statistics_->triangles, drawn.triangles);
    statistics_->items = std::max(statistics_->items, drawn.items);
    statistics_->vectors = std::max(statistics_->vectors, drawn.vectors);
    statistics_->draw_calls += drawn.draw_calls;
    statistics_->pending = statistics_->pending || drawn.pending;
    if (std::strcmp(drawn.splats, "none") != 0) statistics_->splats = drawn.splats;
  }

  Renderer& renderer_;
  const RenderList& list_;
  const PictureOptions& options_;
  FrameStatistics* statistics_;
};

double distance_to(const RenderList& list, const Camera& camera) {
  if (list.bounds.empty()) return 10;
  const glm::dvec3 middle = (glm::dvec3(list.bounds.lower) + glm::dvec3(list.bounds.upper)) * 0.5;
  const double ahead =
      glm::dot(middle - glm::dvec3(camera.world_from_camera[3]), -glm::dvec3(camera.world_from_camera[2]));
  // Inside the scene, use a minimum distance.
  const double least = static_cast<double>(glm::length(list.bounds.size())) * 0.05;
  return std::max({ahead, least, 1e-6});
}

}  // namespace

Eyes eyes_of(const Camera& camera, double eye_distance, double screen_distance) {
  Eyes eyes{camera, camera};
  if (camera.height > 0) {
    // Parallel rays have no origin. So each eye has its own direction, rotated about the point of zero parallax.
    const double half = std::atan(eye_distance / 2 / screen_distance);
    const glm::dvec3 ahead(0, 0, -screen_distance), up(0, 1, 0);
    const auto turn = [&](Camera& eye, double angle) {
      const glm::dmat4 about = glm::translate(glm::dmat4(1), ahead);
      eye.world_from_camera =
          camera.world_from_camera * glm::rotate(about, angle, up) * glm::translate(glm::dmat4(1), -ahead);
    };
    turn(eyes.left, -half);
    turn(eyes.right, half);
    return eyes;
  }
  const glm::dvec4 half = camera.world_from_camera[0] * (eye_distance / 2);
  eyes.left.world_from_camera[3] -= half;
  eyes.right.world_from_camera[3] += half;
  eyes.left.shift += eye_distance / 2 / screen_distance;
  eyes.right.shift -= eye_distance / 2 / screen_distance;
  return eyes;
}

Image without_background(const Image& on_black, const Image& on_white) {
  Image result{on_black.width, on_black.height, 4, {}};
  const std::size_t count = std::size_t{result.width} * result.height;
  result.pixels.resize(count * 4);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint8_t *black = on_black.pixels.data() + 3 * i, *white = on_white.pixels.data() + 3 * i;
    int through = 0;
    for (int c = 0; c < 3; ++c) through += white[c] - black[c];
    const int alpha = std::clamp(255 - (through + 1) / 3, 0, 255);
    std::uint8_t* to = result.pixels.data() + 4 * i;
    for (int c = 0; c < 3; ++c)
      to[c] =
          alpha == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(std::min(255, (black[c] * 255 + alpha / 2) / alpha));
    to[3] = static_cast<std::uint8_t>(alpha);
  }
  return result;
}

Image anaglyph(const Image& left, const Image& right) {
  Image result = right;
  const std::size_t components = right.components;
  for (std::size_t i = 0; i + components <= result.pixels.size(); i += components) {
    const std::uint8_t* from = left.pixels.data() + i;
    // Use the brightness of the left image instead of its red component, so that both eyes see blue and green objects.
    result.pixels[i] = static_cast<std::uint8_t>((299 * from[0] + 587 * from[1] + 114 * from[2] + 500) / 1000);
    if (components == 4) result.pixels[i + 3] = std::max(from[3], right.pixels[i + 3]);
  }
  return result;
}

std::optional<ContextError> draw_picture(Renderer& renderer, const RenderList& list, const Camera& camera,
                                         const PictureOptions& options, const TakeBand& take,
                                         FrameStatistics* statistics) {
  const int width = options.draw.width, height = options.draw.height;
  if (width < 1 || height < 1 || (options.stereo == Stereo::side_by_side && width < 2))
    return ContextError{"a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                        " pixels cannot be drawn"};
  const int most = std::max(renderer.largest_side() / 2 - 2 * kTileBorder, 16);
  const bool at_once = options.most_side == 0 && width <= most && height <= most &&
                       static_cast<std::size_t>(width) * static_cast<std::size_t>(height) <= kMaxPartPixels;
  const int side =
      at_once ? std::max(width, height) : std::min(options.most_side > 0 ? options.most_side : kPictureTile, most);
  const double screen = options.screen_distance > 0 ? options.screen_distance : distance_to(list, camera);
  const Eyes eyes = eyes_of(camera, options.eye_distance > 0 ? options.eye_distance : screen * kEyeDistance, screen);
  PartPainter painter(renderer, list, options, statistics);

  for (int y = 0; y < height; y += side) {
    const int rows = std::min(side, height - y);
    Image band{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(rows), options.transparent ? 4u : 3u, {}};
    band.pixels.resize(std::size_t{band.width} * band.height * band.components);
    const auto columns = [&](const Camera& eye, int left, int eye_width) -> std::optional<ContextError> {
      for (int x = 0; x < eye_width; x += side) {
        auto part = painter.draw(eye, eye_width, height, {x, y, std::min(side, eye_width - x), rows});
        if (auto* problem = std::get_if<ContextError>(&part)) return std::move(*problem);
        paste(std::get<Image>(part), left + x, band);
      }
      return std::nullopt;
    };
    std::optional<ContextError> problem;
    switch (options.stereo) {
      case Stereo::none:
        problem = columns(camera, 0, width);
        break;
      case Stereo::side_by_side:
        problem = columns(eyes.left, 0, width / 2);
        if (!problem) problem = columns(eyes.right, width / 2, width - width / 2);
        break;
      case Stereo::anaglyph:
        problem = columns(eyes.left, 0, width);
        if (!problem) {
          const Image left = band;
          problem = columns(eyes.right, 0, width);
          if (!problem) band = anaglyph(left, band);
        }
        break;
    }
    if (problem) return problem;
    if (!take(band)) return ContextError{"drawing was stopped"};
  }
  return std::nullopt;
}

}  // namespace gs::render
