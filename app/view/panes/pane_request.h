#pragma once

#include <cstddef>
#include <cstdint>

namespace gs::app {

/// What somebody wants of a viewport.
struct PaneRequest {
  enum class Kind : std::uint8_t {
    split_right,
    split_below,
    maximise,  // or all in sight again
    swap,      // with `other`
    even_out,  // all of them
    close,
    weigh,       // `weight`, of its shares
    limit,       // what is read for it: to `rate`
    open_again,  // what it failed to show
    dismiss,     // the failure has been read
  };
  Kind kind = Kind::maximise;
  std::size_t pane = 0, other = 0;
  double weight = 1;
  std::uint64_t rate = 0;  // bits a second; 0: any
};

}  // namespace gs::app
