#pragma once

#include "render/draw/renderer.h"
#include "render/scene/stereo.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>

namespace gs::render {

/// Options of an image that is rendered for export.
struct PictureOptions {
  DrawOptions draw;          // width and height may exceed the driver's limits
  bool transparent = false;  // RGBA instead of RGB, without a background
  Stereo stereo = Stereo::none;
  double eye_distance = 0;     // world units; 0 means kEyeDistance times the distance of the scene
  double screen_distance = 0;  // distance of zero parallax, world units; 0 means the middle of the scene
  int most_side = 0;           // maximum side of a tile; 0 means as large as the driver and memory permit
};

/// Eye distance relative to the viewing distance; comfortable for most people.
inline constexpr double kEyeDistance = 1.0 / 30;

/// Stereo cameras of a viewer at `camera`.
struct Eyes {
  Camera left, right;
};
/// Returns the stereo cameras. They look straight ahead with shifted frustums, so that both see the same point at
/// `screen_distance` at the same image position. With parallel projection, they look at that point from both sides.
[[nodiscard]] Eyes eyes_of(const Camera& camera, double eye_distance, double screen_distance);

/// Receives bands of an image from the top, each of full width, and may take their contents. Returns false to stop.
using TakeBand = std::function<bool(Image& band)>;

/// Draws an image of any size, in tiles if needed. Tiles overlap by a few pixels, which are cut off, so that they
/// match. Returns an error if drawing failed; nullopt otherwise, even if `take` stopped it.
[[nodiscard]] std::optional<ContextError> draw_picture(Renderer& renderer, const RenderList& list, const Camera& camera,
                                                       const PictureOptions& options, const TakeBand& take,
                                                       FrameStatistics* statistics = nullptr);
/// Derives RGBA, not premultiplied, from two images of the same scene on black and on white.
[[nodiscard]] Image without_background(const Image& on_black, const Image& on_white);
/// Combines two images of equal size, RGB or RGBA.
[[nodiscard]] Image anaglyph(const Image& left, const Image& right);

}  // namespace gs::render
