#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Request for an animation.
struct AnimationRequest {
  bool turntable = false;  // move the camera once around the up axis
  std::optional<std::pair<double, double>> times;  // range of world time to show, in seconds from the start
  std::vector<std::string> tour;  // Viewpoints to visit, by description, DEF name or number
  std::size_t pictures = 0;  // number of pictures; 0 means rate times length
  double rate = 25;                                // pictures per second
  double length = 0;  // seconds per turn, or between two Viewpoints; 0 means the default
};

}  // namespace gs::app
