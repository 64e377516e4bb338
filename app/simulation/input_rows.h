#pragma once

#include "app/window/window.h"
#include "vrml/scene/diagnostic.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// What somebody does at a time: a line of an `--input` file.
struct InputRow {
  enum class Kind : std::uint8_t {
    set,             // an event for node `name`, eventIn `event`
    viewpoint,       // the Viewpoint `name` is bound
    move,            // the pointing device points at `pointer`
    press,           // its button goes down there
    release,         // and up there
    key,             // `key` goes down or up
    press_sensor,    // the pointing-device sensor `name` is pressed, wherever it is
    drag_sensor,     // the pointer is moved by `pointer` while it has that
    release_sensor,  // it is released
    visit,           // the viewer is taken to `place`
  };
  Kind kind = Kind::set;
  double time = 0;  // seconds since the world began
  std::string name, event, value;
  glm::dvec2 pointer{0};  // pixels from the upper left of the picture; of drag_sensor to the right and down
  glm::dvec3 place{0};    // world space
  Key key = Key::unknown;
  bool down = false;
  vrml::SourceLocation location;        // of the row's subject in the file
  vrml::SourceLocation value_location;  // of `value`
};

/// Reads the JSON lines of an `--input` file (see the manual page); empty lines are passed over. What is wrong with a
/// line goes to `diagnostics`, under `file`. Pure.
[[nodiscard]] std::vector<InputRow> read_input_rows(std::string_view text, const std::string& file,
                                                    vrml::Diagnostics& diagnostics);

}  // namespace gs::app
