#pragma once

#include "app/session/viewports/view.h"
#include "app/view/viewports.h"
#include "app/window/window_event.h"

// Effects of a world's Scripts on its view, and of the user's input on Scripts (vrml/events/world_browser.h).
namespace gs::app {

/// Tells the Scripts of a world about its viewport, of `place` pixels, and its navigation.
void tell_viewport(Document& document, const View& leader, const Viewport& place);

/// Applies the viewer's pose and the navigation mode that Scripts have requested since the last call. Returns true if
/// the view changed.
bool apply_script_requests(View& leader);

/// Sends a key or a button to the Scripts that listen to the browser's events. Returns true if the key has no further
/// effect, because a Script has cancelled it. Scripts cannot cancel keys with Ctrl or Alt, Esc, Tab and function keys.
/// `now` is the time of the step, in seconds since 1970.
bool send_to_scripts(View& view, const Viewport& place, const WindowEvent& event, double now);

}  // namespace gs::app
