#pragma once

#include "render/scene/render_list.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace gs::render {

/// Lights and ClipPlanes that reach only their group and the groups inside of it, while a traversal is in these groups.
class ScopedNodes {
 public:
  /// Numbers of active nodes before a group.
  struct Mark {
    std::size_t lights = 0, planes = 0;
  };

  void add_light(std::size_t index) {
    active_lights_.push_back(static_cast<std::uint16_t>(index));
    lights_changed_ = true;
  }
  void add_plane(std::size_t index) {
    active_planes_.push_back(static_cast<std::uint16_t>(index));
    planes_changed_ = true;
  }
  [[nodiscard]] Mark mark() const { return {active_lights_.size(), active_planes_.size()}; }
  /// Removes the nodes that were added after a mark.
  void return_to(const Mark& mark) {
    lights_changed_ = lights_changed_ || active_lights_.size() != mark.lights;
    active_lights_.resize(mark.lights);
    planes_changed_ = planes_changed_ || active_planes_.size() != mark.planes;
    active_planes_.resize(mark.planes);
  }
  /// Returns the active lights. If there are too many, returns the innermost lights.
  [[nodiscard]] const LightList& lights() {
    if (std::exchange(lights_changed_, false)) {
      const std::size_t count = std::min(active_lights_.size(), kMaxLightsOfAnItem);
      lights_ = LightList(std::span<const std::uint16_t>(active_lights_).last(count));
    }
    return lights_;
  }
  /// Returns the four planes of a Viewport, from `first_edge` on, and the active ClipPlanes. If there are too many,
  /// returns the outermost ones.
  [[nodiscard]] const ClipList& planes(std::optional<std::uint32_t> first_edge) {
    const bool moved = std::exchange(edge_of_planes_, first_edge) != first_edge;
    if (std::exchange(planes_changed_, false) || moved) {
      std::vector<std::uint16_t> all;
      for (std::uint32_t edge = 0; edge < 4 && first_edge; ++edge)
        all.push_back(static_cast<std::uint16_t>(*first_edge + edge));
      const std::size_t count = std::min(active_planes_.size(), kMaxClipPlanes - all.size());
      all.insert(all.end(), active_planes_.begin(), active_planes_.begin() + static_cast<std::ptrdiff_t>(count));
      planes_ = ClipList(std::span<const std::uint16_t>(all));
    }
    return planes_;
  }

 private:
  std::vector<std::uint16_t> active_lights_, active_planes_;
  LightList lights_;                             // the items of a group share this list
  ClipList planes_;                              // the items of a group share this list
  std::optional<std::uint32_t> edge_of_planes_;  // `first_edge` of planes_
  bool lights_changed_ = false, planes_changed_ = false;
};

}  // namespace gs::render
