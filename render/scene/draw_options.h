#pragma once

#include "render/scene/splat_style.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace gs::render {

struct RenderList;

/// Renderer of surface vectors. automatic: OpenGL, or the CPU if OpenGL is a software driver.
enum class SplatPath : std::uint8_t { automatic, gl, cpu };

/// Ambient occlusion of meshes. hardware: unless OpenGL is a software driver, where it costs much time.
enum class Occlusion : std::uint8_t { none, hardware, always };

/// Drawing mode of faces. Does not affect splats and volumes, which have no faces.
enum class DisplayMode : std::uint8_t { surface, edges, wireframe, points };

/// Function that is called during drawing and returns false to cancel. Null means that drawing is never cancelled.
struct CancellationCheck : std::function<bool()> {
  using std::function<bool()>::function;
  /// Always true: the function does not affect the image.
  friend bool operator==(const CancellationCheck&, const CancellationCheck&) { return true; }
};

/// Options of a frame. With equal options, one list gives equal images, unless drawing is cancelled.
struct DrawOptions {
  int x = 0, y = 0, width = 1024, height = 768;  // rectangle in the target, in pixels from its lower left corner
  int samples = 4;  // samples per pixel for anti-aliasing; at most the context's limit
  int pixel_side = 1;  // side of an image pixel in target pixels
  float coarseness = 1;  // factor by which the resolution is reduced in each direction
  bool headlight = true;
  glm::vec3 headlight_towards{0, 0, 1};  // unit vector in camera space, from the scene towards the headlight
  bool visibility_limit = true;  // apply the visibilityLimit of the bound NavigationInfo (VRML97 6.29)
  float unit = 1;  // for the visibility limit: world units per unit of the Viewpoint
  std::size_t budget = 0;  // maximum splats of all items together; 0 means unlimited
  std::optional<glm::vec3> background;  // colour that replaces the world's Background
  bool backdrop = false;  // neutral gradient instead of the world's Background, unless `background` is set
  Occlusion occlusion = Occlusion::none;
  DisplayMode display = DisplayMode::surface;
  SplatPath splats = SplatPath::automatic;
  /// Helper lines. They are drawn with the same depth test, unlit and without fog. May be null.
  std::shared_ptr<const RenderList> guides;
  SplatStyle splat_style;
  std::uint32_t viewport = 0;  // index of the viewport; each viewport has its own level of detail
  std::optional<double> time;  // seconds of the viewport's clock, for fades; nullopt means no fades
  float splat_error = 1;  // error of streams of Gaussians, in pixels; a larger error gives fewer Gaussians
  bool fade = true;  // if false, changes of Gaussians are immediate, even with a `time`
  std::size_t most_gaussians = 0;  // maximum Gaussians of all items in a changing picture; 0 means unlimited
  std::size_t most_decoded = 0;  // maximum splats to decode for this frame; 0 means unlimited
  CancellationCheck go_on;  // called several times per second; returns false to cancel the rest of the frame
  int target_samples = 64;  // maximum samples of OpenGL drawing; CPU rasterizers have their own sampling
  friend bool operator==(const DrawOptions&, const DrawOptions&) = default;
};

struct FrameStatistics {
  std::size_t triangles = 0, items = 0, draw_calls = 0;
  std::size_t vectors = 0;  // vectors in view
  std::size_t gaussians = 0;  // Gaussians that were drawn, in view or not
  const char* splats =
      "none";             // rendering path in use: "gl" or "cpu"; also "cpu" if OpenGL was requested but unavailable
  bool pending = false;  // more detail will be available for this view: draw again
  bool working = false;  // another thread prepares more detail: draw again when it has changed
  bool given_up = false;  // `go_on` cancelled the frame: an earlier image is shown, if any
};

}  // namespace gs::render
