#pragma once

#include "render/draw/renderer.h"
#include "render/scene/stereo.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <variant>

namespace gs::render {

/// A picture that is to be kept.
struct PictureOptions {
  DrawOptions draw;          // width and height may be more than the driver can draw at once
  bool transparent = false;  // RGBA in place of RGB, without any background
  Stereo stereo = Stereo::none;
  double eye_distance = 0;     // world units; 0: kEyeDistance of how far away the scene is
  double screen_distance = 0;  // where both eyes see the same, world units; 0: at the middle of the scene
  int most_side = 0;           // of what is drawn at once; 0: as the driver and memory allow
};

/// Of the distance to what is looked at: comfortable for most people.
inline constexpr double kEyeDistance = 1.0 / 30;

/// The eyes of who stands at `camera`.
struct Eyes {
  Camera left, right;
};
/// They look straight ahead, their lenses are shifted: at `screen_distance` both see the same place of their pictures.
/// By parallel rays they look towards what is there from both sides.
[[nodiscard]] Eyes eyes_of(const Camera& camera, double eye_distance, double screen_distance);

/// Takes bands of a picture, from the top, each as wide as the picture, which are its own then; false: no more is
/// wanted.
using TakeBand = std::function<bool(Image& band)>;

/// Draws a picture of any size, tile by tile where it must be. The tiles lie over their neighbours by some pixels that
/// are cut away, so that they fit together. What is wrong, if anything; also where no more was wanted.
[[nodiscard]] std::optional<ContextError> draw_picture(Renderer& renderer, const RenderList& list, const Camera& camera,
                                                       const PictureOptions& options, const TakeBand& take,
                                                       FrameStatistics* statistics = nullptr);
/// The whole of it.
[[nodiscard]] std::variant<Image, ContextError> draw_whole_picture(Renderer& renderer, const RenderList& list,
                                                                   const Camera& camera, const PictureOptions& options,
                                                                   FrameStatistics* statistics = nullptr);

/// What lies before a background that is black in one picture and white in the other: RGBA, colours not multiplied with
/// alpha.
[[nodiscard]] Image without_background(const Image& on_black, const Image& on_white);
/// RGB or RGBA of two pictures of one size.
[[nodiscard]] Image anaglyph(const Image& left, const Image& right);

}  // namespace gs::render
