#pragma once

#include <cstddef>
#include <cstdint>

namespace gs::app {

/// Request to change one viewport.
struct PaneRequest {
  enum class Kind : std::uint8_t {
    split_right,
    split_below,
    maximise,  // maximises the viewport, or restores all
    swap,      // swaps the viewport with viewport `other`
    even_out,  // makes all viewports equally large
    close,
    weigh,       // sets the viewport's weight to `weight`
    limit,       // sets the bandwidth limit to `rate`
    open_again,  // opens the file that failed again, or reloads the displayed one
    dismiss,     // dismisses the error message
  };
  Kind kind = Kind::maximise;
  std::size_t pane = 0, other = 0;
  double weight = 1;
  std::uint64_t rate = 0;  // bits/s; 0 means unlimited
};

}  // namespace gs::app
