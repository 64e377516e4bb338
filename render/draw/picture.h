#pragma once

#include "render/draw/renderer.h"
#include "render/scene/stereo.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>

namespace gs::render {

/// Options of an exported image.
struct PictureOptions {
  DrawOptions draw;  // the size may exceed the driver's limits
  bool transparent = false;  // RGBA without a background, instead of RGB
  Stereo stereo = Stereo::none;
  double eye_distance = 0;  // distance of the eyes, world units; 0: kEyeDistance times the distance of the scene
  double screen_distance = 0;  // distance of zero parallax, world units; 0 means the middle of the scene
  int most_side = 0;  // maximum side of a tile in pixels; 0 means as large as driver and memory permit
};

/// Distance between the eyes, relative to the viewing distance. Comfortable for most people.
inline constexpr double kEyeDistance = 1.0 / 30;

/// Two cameras for a stereo image.
struct Eyes {
  Camera left, right;
};
/// Returns the stereo cameras of a viewer at `camera`. They look in one direction with shifted frustums: a point at
/// `screen_distance` has one position in both images. With parallel projection, they look at that point from two sides.
[[nodiscard]] Eyes eyes_of(const Camera& camera, double eye_distance, double screen_distance);

/// Receiver of the bands of an image, from the top, each of full width. May take their pixels. Returns false to stop.
using TakeBand = std::function<bool(Image& band)>;

/// Draws an image of any size, in tiles if necessary. Tiles have a margin, which is removed, so that neighbours match.
/// Returns an error if drawing failed. Returns nullopt on success and if `take` stopped it.
[[nodiscard]] std::optional<ContextError> draw_picture(Renderer& renderer, const RenderList& list, const Camera& camera,
                                                       const PictureOptions& options, const TakeBand& take,
                                                       FrameStatistics* statistics = nullptr);
/// Computes RGBA, not premultiplied, from two images of one scene: on black and on white.
[[nodiscard]] Image without_background(const Image& on_black, const Image& on_white);
/// Combines two images of equal size, RGB or RGBA, into a red and cyan stereo image.
[[nodiscard]] Image anaglyph(const Image& left, const Image& right);

}  // namespace gs::render
