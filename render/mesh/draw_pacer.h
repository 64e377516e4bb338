#pragma once

#include "render/gl/gl.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>

namespace gs::render {

/// Makes drawing cancellable: draws are split into slices, each finished before the next begins, and the callback is
/// polled between two slices. Slices double while they are fast and shrink when they are slow, since the pixels per
/// triangle are unknown in advance. Software drivers store a slice's triangles until other threads have filled their
/// pixels. The slices in flight are therefore limited even without a callback. Belongs to the thread of the context.
class DrawPacer {
 public:
  /// `go_on` may be null. `pixels` is the size of the target.
  DrawPacer(const Gl& gl, const std::function<bool()>& go_on, std::size_t pixels);
  ~DrawPacer();
  DrawPacer(const DrawPacer&) = delete;
  DrawPacer& operator=(const DrawPacer&) = delete;

  /// Returns the number of primitives that may be drawn before the next `spend`; at least 1.
  [[nodiscard]] std::size_t room() const { return slice_ - spent_; }
  /// Counts drawn primitives, at most `room()`.
  void spend(std::size_t primitives);
  /// Reports whether the rest of the image must not be drawn.
  [[nodiscard]] bool given_up() const { return given_up_; }

 private:
  using Clock = std::chrono::steady_clock;

  const Gl& gl_;
  const std::function<bool()>& go_on_;
  std::size_t slice_, spent_ = 0;  // primitives
  Clock::time_point begin_;        // start of the slice
  bool given_up_ = false;
  std::array<GLsync, 2> filled_{};  // fences of the last slices; the oldest is at `oldest_`
  std::size_t oldest_ = 0;
};

}  // namespace gs::render
