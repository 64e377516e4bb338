#pragma once

#include "app/view/navigation.h"

#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Formats a pose as "position=X,Y,Z orientation=X,Y,Z,RADIANS fieldOfView=RADIANS". A parallel projection appends
/// "height=H" in world units. Coordinates are world space; names and units are those of VRML97's Viewpoint (6.53).
[[nodiscard]] std::string camera_text(const Pose& pose);
/// Formats a pose as a Viewpoint node, which has no parallel projection.
[[nodiscard]] std::string viewpoint_text(const Pose& pose);

/// Parses either format. Omitted fields have Viewpoint's defaults (6.53); height defaults to 0. Returns a message with
/// the expected syntax on failure. Safe for untrusted text.
[[nodiscard]] std::variant<Pose, std::string> read_camera(std::string_view text);

}  // namespace gs::app
