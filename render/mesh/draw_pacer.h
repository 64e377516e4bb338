#pragma once

#include "render/gl/gl.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>

namespace gs::render {

/// Lets whoever waits for a picture give it up: draws are cut into slices, each of which is finished before the next
/// begins, and between two it is asked whether to go on. A slice is twice as large as the last one while that took
/// little time, and smaller when it took long: nobody knows before how many pixels a triangle fills. Where nobody gives
/// up, a driver on the processor still has few slices at a time: it keeps the triangles of each until their pixels are
/// filled, which other threads do meanwhile. Thread of the context.
class DrawPacer {
 public:
  /// `go_on` may be null. `pixels`: of the target.
  DrawPacer(const Gl& gl, const std::function<bool()>& go_on, std::size_t pixels);
  ~DrawPacer();
  DrawPacer(const DrawPacer&) = delete;
  DrawPacer& operator=(const DrawPacer&) = delete;

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
  std::array<GLsync, 2> filled_{};  // when the last slices are; the oldest is at `oldest_`
  std::size_t oldest_ = 0;
};

}  // namespace gs::render
