#pragma once

#include "render/scene/cloud_look.h"

#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>

namespace gs::render {

struct RenderList;

/// Rendering path of surface vectors. automatic: OpenGL, or the CPU if OpenGL is a software driver.
enum class SplatPath : std::uint8_t { automatic, gl, cpu };

/// Drawing mode of faces. Splats and volumes have no faces and are not affected.
enum class DisplayMode : std::uint8_t { surface, edges, wireframe, points };

/// Cancellation check that is polled during drawing; null means never cancelled.
struct CancellationCheck : std::function<bool()> {
  using std::function<bool()>::function;
  /// The check does not affect the image, so any two are equal.
  friend bool operator==(const CancellationCheck&, const CancellationCheck&) { return true; }
};

/// Options of a frame. Equal options give the same image of the same list, unless drawing is cancelled.
struct DrawOptions {
  int x = 0, y = 0, width = 1024, height = 768;  // pixels of the target, from its lower left
  int samples = 4;                               // anti-aliasing; reduced to the context's limit
  int pixel_side = 1;                            // size of an image pixel in target pixels
  int coarseness = 1;                            // reduction factor of the resolution in each direction
  bool headlight = true;
  bool visibility_limit = true;         // apply that of the bound NavigationInfo (VRML97 6.29)
  float unit = 1;                       // world units per unit of the bound Viewpoint; for the visibility limit
  std::size_t budget = 0;               // splats of all point sets in total; 0 means unlimited
  std::optional<glm::vec3> background;  // replaces the world's Background
  bool backdrop = false;  // neutral gradient instead of the world's Background, unless `background` is set
  DisplayMode display = DisplayMode::surface;
  SplatPath splats = SplatPath::automatic;
  /// Helper lines, drawn with the same depth test, unlit and without fog. Null means none.
  std::shared_ptr<const RenderList> guides;
  SplatStyle clouds;
  std::uint32_t viewport = 0;    // number of the viewport; each keeps its own level of detail
  std::size_t most_decoded = 0;  // splats that may be decoded for this frame; 0 means unlimited
  CancellationCheck go_on;       // polled several times per second; false cancels the rest. Null means never
  int target_samples = 64;       // maximum for OpenGL drawing; CPU rasterizers use their own sampling
  friend bool operator==(const DrawOptions&, const DrawOptions&) = default;
};

struct FrameStatistics {
  std::size_t triangles = 0, items = 0, draw_calls = 0;
  std::size_t vectors = 0;  // vectors of point sets in view
  const char* splats =
      "none";             // rendering path in use: "gl" or "cpu"; also "cpu" if OpenGL was requested but unavailable
  bool pending = false;   // more detail for this view is on its way: draw again
  bool given_up = false;  // `go_on` cancelled it: the image is incomplete, and hidden if there is a previous one
};

}  // namespace gs::render
