#pragma once

#include "app/view/navigation.h"

#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Formats a pose as "position=X,Y,Z orientation=X,Y,Z,RADIANS fieldOfView=RADIANS". For a parallel projection,
/// "height=H" in world units follows. Coordinates are in world space. Names and units are those of a VRML97 Viewpoint
/// (6.53).
[[nodiscard]] std::string camera_text(const Pose& pose);
/// Formats a pose as a Viewpoint node. Its projection is always perspective.
[[nodiscard]] std::string viewpoint_text(const Pose& pose);

/// Parses the text of camera_text() or viewpoint_text(). Missing fields have the defaults of a Viewpoint (6.53); a
/// missing height is 0. Returns a message with the expected form if the text is invalid. Safe for untrusted text.
[[nodiscard]] std::variant<Pose, std::string> read_camera(std::string_view text);

}  // namespace gs::app
