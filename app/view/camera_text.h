#pragma once

#include "app/view/navigation.h"

#include <string>
#include <string_view>
#include <variant>

namespace gs::app {

/// Where somebody looks from, as text: "position=X,Y,Z orientation=X,Y,Z,RADIANS fieldOfView=RADIANS", with "height=H"
/// in world units behind it where he sees by parallel rays. World space; the names and units are those of VRML97's
/// Viewpoint (6.53).
[[nodiscard]] std::string camera_text(const Pose& pose);
/// The same as a Viewpoint node, which has no parallel rays.
[[nodiscard]] std::string viewpoint_text(const Pose& pose);

/// Either of them; what is left out is as in a Viewpoint that says nothing (6.53), but for `height`, which is 0. What
/// is wrong, and what was expected. Safe for any text.
[[nodiscard]] std::variant<Pose, std::string> read_camera(std::string_view text);

}  // namespace gs::app
