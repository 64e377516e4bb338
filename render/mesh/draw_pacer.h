#pragma once

#include "base/noncopyable.h"
#include "render/gl/gl.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <functional>

namespace gs::render {

/// Makes drawing cancellable. Splits draws into slices, and calls `go_on` between two slices. Each slice is finished
/// before the next begins. The pixels per triangle are unknown, so slices double if they are fast and shrink if they
/// are slow.
///
/// Software drivers store the triangles of a slice until other threads have filled their pixels. So the slices in
/// flight are limited even without `go_on`. Runs on the thread of the context.
class DrawPacer : NonCopyable {
 public:
  /// Starts a frame. `go_on` returns false to cancel and may be null. `pixels` is the number of pixels of the target.
  DrawPacer(const Gl& gl, const std::function<bool()>& go_on, std::size_t pixels);
  ~DrawPacer();

  /// Returns the number of primitives that may be drawn before the next `spend`; at least 1.
  [[nodiscard]] std::size_t room() const { return slice_ - spent_; }
  /// Counts `primitives` as drawn; at most room().
  void spend(std::size_t primitives);
  /// Reports whether drawing is cancelled. If so, the rest of the image must not be drawn.
  [[nodiscard]] bool given_up() const { return given_up_; }

 private:
  using Clock = std::chrono::steady_clock;

  const Gl& gl_;
  const std::function<bool()>& go_on_;
  std::size_t slice_, spent_ = 0;  // primitives of a slice, and primitives drawn in the current slice
  Clock::time_point begin_;  // start time of the slice
  bool given_up_ = false;
  std::array<GLsync, 2> filled_{};  // fences of the last two slices; the older fence is at index oldest_
  std::size_t oldest_ = 0;
};

}  // namespace gs::render
