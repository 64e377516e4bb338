#pragma once

#include "app/view/viewports.h"

#include <imgui.h>

#include <algorithm>

namespace gs::app {

/// Window flags for text lines and cards over a picture, with automatic size.
inline constexpr ImGuiWindowFlags kLineFlags = ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoNav |
                                               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                                               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoFocusOnAppearing |
                                               ImGuiWindowFlags_NoBringToFrontOnFocus;

/// Rectangle of a viewport in Dear ImGui units.
struct ViewportArea {
  ImVec2 lower, upper;
  [[nodiscard]] float width() const { return upper.x - lower.x; }
  [[nodiscard]] float height() const { return upper.y - lower.y; }
  [[nodiscard]] bool contains(const ImVec2& place) const {
    return place.x >= lower.x && place.y >= lower.y && place.x < upper.x && place.y < upper.y;
  }
};

/// Returns the size of a framebuffer pixel in Dear ImGui units.
inline ImVec2 units_of_pixel() {
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
  return {1 / std::max(pixels.x, 0.01f), 1 / std::max(pixels.y, 0.01f)};
}

inline ViewportArea area_of(const Viewport& place) {
  const ImVec2 unit = units_of_pixel();
  const auto left = static_cast<float>(place.left), top = static_cast<float>(place.top);
  return {{left * unit.x, top * unit.y},
          {(left + static_cast<float>(place.width)) * unit.x, (top + static_cast<float>(place.height)) * unit.y}};
}

}  // namespace gs::app
