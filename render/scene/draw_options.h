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

/// How surfaces of QNV vectors are drawn. automatic: with OpenGL, but on the processor where OpenGL itself is software.
enum class SplatPath : std::uint8_t { automatic, gl, cpu };

/// How faces are drawn. Clouds of discs and volumes have none, and are drawn as they are.
enum class DisplayMode : std::uint8_t { surface, edges, wireframe, points };

/// Whether drawing goes on, as who draws is asked; null: yes.
struct GoOn : std::function<bool()> {
  using std::function<bool()>::function;
  /// It says nothing about the picture that is drawn.
  friend bool operator==(const GoOn&, const GoOn&) { return true; }
};

/// Two that are equal give the same picture of the same list, as far as it is whole.
struct DrawOptions {
  int x = 0, y = 0, width = 1024, height = 768;  // pixels of the target, from its lower left
  int samples = 4;                               // anti-aliasing; lowered to what the context can
  int pixel_side = 1;                            // of the picture's pixels, in pixels of the target
  int coarseness = 1;                            // of who shows it: drawn with so many times fewer pixels each way
  bool headlight = true;
  bool visibility_limit = true;         // what lies behind that of the bound NavigationInfo is not drawn (VRML97 6.29)
  float unit = 1;                       // world units that a unit of the bound Viewpoint's is long; of that limit
  std::size_t budget = 0;               // discs of all clouds together; 0: no limit
  std::optional<glm::vec3> background;  // one colour in place of the world's Background
  bool backdrop = false;                // a neutral gradient in place of the world's Background, if `background` is none
  DisplayMode display = DisplayMode::surface;
  SplatPath splats = SplatPath::automatic;
  /// Drawn with the same depths, and neither lit nor in fog: lines that help to see where things are. Null: none.
  std::shared_ptr<const RenderList> guides;
  CloudLook clouds;
  std::uint32_t viewport = 0;    // which of those that are drawn by turns; each keeps its own detail
  std::size_t most_decoded = 0;  // discs that may be decoded for this frame; 0: as many as it needs
  GoOn go_on;                    // asked some times a second; false: what is not drawn yet is left out. Null: true
  int target_samples = 64;       // at most, of what OpenGL draws: what the processor rasterises has samples of its own
  friend bool operator==(const DrawOptions&, const DrawOptions&) = default;
};

struct FrameStatistics {
  std::size_t triangles = 0, items = 0, draw_calls = 0;
  std::size_t vectors = 0;  // of clouds, in view
  const char* splats =
      "none";             // how they were drawn: "gl" or "cpu"; "cpu" too where OpenGL was asked for and could not
  bool pending = false;   // detail that belongs to this view is not there yet: drawn again, it is better
  bool given_up = false;  // `go_on` said so: the picture is not whole, and is not shown where there is a former one
};

}  // namespace gs::render
