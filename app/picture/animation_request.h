#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Animation options of a request.
struct AnimationRequest {
  bool turntable = false;                          // one turn about the up axis
  std::optional<std::pair<double, double>> times;  // world times to show, in seconds from the start
  std::vector<std::string> tour;                   // Viewpoints by description, DEF name or number
  std::size_t pictures = 0;                        // 0 means rate times length
  double rate = 25;                                // pictures per second
  double length = 0;                               // seconds per turn, or per pair of Viewpoints; 0 means the default
};

}  // namespace gs::app
