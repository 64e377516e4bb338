#pragma once

#include "app/window/window.h"
#include "base/diagnostic.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// User input at one time: a line of an `--input` file.
struct InputRow {
  enum class Kind : std::uint8_t {
    set,  // sends event `event` with `value` to node `name`
    viewpoint,       // binds the Viewpoint `name`
    move,            // moves the pointing device to `pointer`
    press,  // presses the button of the pointing device there
    release,  // releases the button there
    key,             // presses or releases `key`
    press_sensor,  // presses the pointing-device sensor `name` without regard to the pointer's position
    drag_sensor,  // moves the pointer by `pointer` while that sensor is pressed
    release_sensor,  // releases that sensor
    visit,           // moves the viewer to `place`
  };
  Kind kind = Kind::set;
  double time = 0;  // seconds since the start of the world
  std::string name, event, value;
  glm::dvec2 pointer{0};  // pixels from the upper left of the picture; for drag_sensor, pixels to the right and down
  glm::dvec3 place{0};  // world space, metres
  Key key = Key::unknown;
  bool down = false;
  SourceLocation location;  // of the main value of the line
  SourceLocation value_location;  // of the value for `value`
};

/// Parses the JSON lines of an `--input` file (see the manual page). Skips empty lines. Adds errors to `diagnostics`,
/// with `file` as the file name.
[[nodiscard]] std::vector<InputRow> read_input_rows(std::string_view text, const std::string& file,
                                                    Diagnostics& diagnostics);

}  // namespace gs::app
