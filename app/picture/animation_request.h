#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// What an animation shows.
struct AnimationRequest {
  bool turntable = false;                          // once about the up axis
  std::optional<std::pair<double, double>> times;  // the world's own, seconds from its start
  std::vector<std::string> tour;                   // Viewpoints, by description, DEF name or number
  std::size_t pictures = 0;                        // 0: as many as the rate and the length have
  double rate = 25;                                // pictures a second
  double length = 0;                               // seconds of a turntable, or between two Viewpoints; 0: the usual
};

}  // namespace gs::app
