#pragma once

#include "app/session/viewports/view.h"
#include "app/window/window_event.h"

namespace gs::app {

/// Sends a key to the KeySensors and StringSensors of a world (X3D clause 21). Returns true if the world takes the
/// key, so that it moves no camera and starts no action. While a sensor is enabled, a world takes all keys except those
/// with Ctrl or Alt, Esc, Tab and F1 to F12: these stay with the interface, and the world only receives their events.
bool send_to_key_sensors(View& view, const WindowEvent& event, double now);
/// Reports whether send_to_key_sensors() would take the key.
[[nodiscard]] bool world_takes_key(const View& view, const WindowEvent& event);

}  // namespace gs::app
