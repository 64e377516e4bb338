#pragma once

#include "app/window/window.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::app {

/// Where a world is drawn in the window: framebuffer pixels, `top` from the upper edge.
struct Viewport {
  int left = 0, top = 0, width = 1, height = 1;

  [[nodiscard]] glm::vec2 size() const { return glm::vec2(width, height); }
  [[nodiscard]] glm::vec2 inside(const glm::vec2& pointer) const { return pointer - glm::vec2(left, top); }
  [[nodiscard]] bool contains(const glm::vec2& pointer) const {
    const glm::vec2 place = inside(pointer), end = size();
    return place.x >= 0 && place.y >= 0 && place.x < end.x && place.y < end.y;
  }
  [[nodiscard]] std::size_t pixels() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

/// The one that has the pixel under `pointer`.
[[nodiscard]] std::optional<std::size_t> viewport_at(std::span<const Viewport> viewports, const glm::vec2& pointer);

/// Tells which viewport the pointer's events belong to: a drag stays with the one where it began.
class PointerRouter {
 public:
  /// The index in `viewports` of the one that `event` is for; nothing for events that the pointer does not make, and
  /// for those beside all viewports. A button that goes down begins a drag.
  std::optional<std::size_t> route(const WindowEvent& event, std::span<const Viewport> viewports);
  /// Ends all drags, as when the viewports change.
  void release() { held_ = 0; }

 private:
  std::size_t owner_ = 0;
  unsigned held_ = 0;  // buttons, a bit each
};

/// Parts of `total` in proportion to `weights`, each at least 1, and 0 for a weight of 0.
[[nodiscard]] std::vector<std::size_t> shares_of(std::size_t total, std::span<const std::size_t> weights);

/// Tells whether to draw again because a picture gets better by that. Detail that is always promised and never comes
/// counts as there after a while, so that a window that rests costs nothing.
class Refinement {
 public:
  /// What the last frame of all viewports said: `pending` of any, the discs of all. `changed`: the view or the input.
  void note(bool pending, std::size_t discs, bool changed);
  [[nodiscard]] bool wanted() const { return pending_ && frames_ < kMostFramesAlike; }

  static constexpr int kMostFramesAlike = 60;

 private:
  bool pending_ = false;
  std::size_t discs_ = 0;
  int frames_ = 0;  // one after another that brought nothing
};

}  // namespace gs::app
