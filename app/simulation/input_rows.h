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

/// User input at a time: a line of an `--input` file.
struct InputRow {
  enum class Kind : std::uint8_t {
    set,             // sends an event to eventIn `event` of node `name`
    viewpoint,       // binds the Viewpoint `name`
    move,            // moves the pointing device to `pointer`
    press,           // presses its button there
    release,         // releases its button there
    key,             // presses or releases `key`
    press_sensor,    // presses the pointing-device sensor `name`, wherever it is
    drag_sensor,     // moves the pointer by `pointer` while a sensor is pressed
    release_sensor,  // releases the sensor
    visit,           // moves the viewer to `place`
  };
  Kind kind = Kind::set;
  double time = 0;  // seconds since the world began
  std::string name, event, value;
  glm::dvec2 pointer{0};  // pixels from the upper left of the picture; for drag_sensor, pixels right and down
  glm::dvec3 place{0};    // world space
  Key key = Key::unknown;
  bool down = false;
  SourceLocation location;        // of the row's subject in the file
  SourceLocation value_location;  // of `value`
};

/// Parses the JSON lines of an `--input` file (see the manual page). Skips empty lines. Adds errors to `diagnostics`,
/// under `file`. Pure.
[[nodiscard]] std::vector<InputRow> read_input_rows(std::string_view text, const std::string& file,
                                                    Diagnostics& diagnostics);

}  // namespace gs::app
