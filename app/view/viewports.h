#pragma once

#include "app/window/window.h"

#include <glm/vec2.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gs::app {

/// Rectangle of a viewport in framebuffer pixels. `top` is measured from the upper edge.
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

/// Returns the index of the viewport under `pointer`, in framebuffer pixels; nullopt if there is none.
[[nodiscard]] std::optional<std::size_t> viewport_at(std::span<const Viewport> viewports, const glm::vec2& pointer);

/// Assignment of pointer events to viewports. A drag belongs to the viewport in which it began.
class PointerRouter {
 public:
  /// Returns the index of the viewport that must handle `event`. Returns nullopt if it is no pointer event, or if the
  /// pointer is outside of all viewports. Pressing a button starts a drag.
  std::optional<std::size_t> route(const WindowEvent& event, std::span<const Viewport> viewports);
  /// Ends all drags. Call when the viewports change.
  void release() { held_ = 0; }

 private:
  std::size_t owner_ = 0;
  unsigned held_ = 0;  // held buttons, one bit each
};

/// Divides `total` in proportion to `weights`. Each share is at least 1, but 0 if the weight is 0.
[[nodiscard]] std::vector<std::size_t> shares_of(std::size_t total, std::span<const std::size_t> weights);

/// Decision whether drawing again would add detail. After kMaxFramesAlike frames without progress the answer is no, so
/// that an idle window needs no processor time.
class Refinement {
 public:
  /// Records the last frame: whether more detail is `pending`, the number of splats drawn, and whether view or input
  /// `changed`.
  void note(bool pending, std::size_t discs, bool changed);
  [[nodiscard]] bool wanted() const { return pending_ && frames_ < kMaxFramesAlike; }

  static constexpr int kMaxFramesAlike = 60;

 private:
  bool pending_ = false;
  std::size_t discs_ = 0;
  int frames_ = 0;  // number of consecutive frames without progress
};

}  // namespace gs::app
