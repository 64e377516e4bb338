#pragma once

#include <cstddef>
#include <cstdint>

namespace gs::app {

/// Request to change a viewport.
struct PaneRequest {
  enum class Kind : std::uint8_t {
    split_right,
    split_below,
    maximise,  // toggles
    swap,      // with `other`
    even_out,  // all viewports
    close,
    weigh,       // sets its share of the layout to `weight`
    limit,       // limits its downloads to `rate`
    open_again,  // retries a failed load
    dismiss,     // dismisses the error message
  };
  Kind kind = Kind::maximise;
  std::size_t pane = 0, other = 0;
  double weight = 1;
  std::uint64_t rate = 0;  // bits/s; 0 means unlimited
};

}  // namespace gs::app
