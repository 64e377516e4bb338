#pragma once

#include "render/gl/gl.h"

#include <chrono>
#include <cstddef>
#include <functional>

namespace gs::render {

/// Lets whoever waits for a picture give it up: draws are cut into slices, each of which is finished before the next
/// begins, and between two it is asked whether to go on. A slice is twice as large as the last one while that took
/// little time, and smaller when it took long: nobody knows before how many pixels a triangle fills. Thread of the
/// context.
class DrawPacer {
 public:
  /// Where `go_on` is null nothing is waited for; there are slices only where the driver draws on the processor. `pixels`: of the target.
  DrawPacer(const Gl& gl, const std::function<bool()>& go_on, std::size_t pixels);

  /// How many primitives may be drawn before the next `spend`: at least 1.
  [[nodiscard]] std::size_t room() const { return slice_ - spent_; }
  /// To be called when so many, at most `room()`, were drawn.
  void spend(std::size_t primitives);
  /// The rest of the picture is not drawn.
  [[nodiscard]] bool given_up() const { return given_up_; }

 private:
  using Clock = std::chrono::steady_clock;

  const Gl& gl_;
  const std::function<bool()>& go_on_;
  std::size_t slice_, spent_ = 0;  // primitives
  Clock::time_point begin_;        // of the slice
  bool given_up_ = false;
};

}  // namespace gs::render
