#include "app/view/navigation.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gs::app {
namespace {

constexpr double kSizesOfAvatar = 12;  // without a NavigationInfo, min ratio of the world's size to the avatar's height

const std::string kExamineType = "EXAMINE";

// Reports whether a point is inside of all regions.
bool is_around(const std::vector<render::ViewpointRegion>& regions, const glm::dvec3& point) {
  return std::all_of(regions.begin(), regions.end(), [&](const render::ViewpointRegion& region) {
    const glm::dvec3 away = glm::abs(glm::dvec3(region.group_from_world * glm::dvec4(point, 1)) - region.center);
    return away.x <= region.half.x && away.y <= region.half.y && away.z <= region.half.z;
  });
}

}  // namespace

const std::array<NavigationModeRow, kNavigationModeCount>& navigation_modes() {
  static constexpr std::array<NavigationModeRow, kNavigationModeCount> kRows = {{
      {NavigationMode::none, "NONE", "None", "The world controls the viewer"},
      {NavigationMode::examine, "EXAMINE", "Examine", "Turn about a point"},
      {NavigationMode::fly, "FLY", "Fly", "Move freely"},
      {NavigationMode::walk, "WALK", "Walk", "Stay on the ground"},
      {NavigationMode::pan, "", "Pan", "Slide the view"},
      {NavigationMode::look_at, "LOOKAT", "Look at", "Go to a clicked point"},
  }};
  return kRows;
}

const NavigationModeRow& row_of(NavigationMode mode) { return navigation_modes()[static_cast<std::size_t>(mode)]; }

NavigationRules navigation_rules(const render::NavigationState& navigation) {
  NavigationRules rules;
  rules.speed = navigation.speed;
  rules.avatar.radius = double{navigation.avatar_size[0]};
  rules.avatar.height = double{navigation.avatar_size[1]};
  rules.avatar.step = double{navigation.avatar_size[2]};
  bool any = false;
  std::optional<NavigationMode> start;
  for (const std::string& given : navigation.types) {
    // EXPLORE of X3D 4 stands for any movement about and towards objects (X3D 23.4.4).
    const std::string& type = given == "EXPLORE" ? kExamineType : given;
    any |= type == "ANY";
    for (const NavigationModeRow& row : navigation_modes()) {
      if (row.type.empty() || row.type != type) continue;
      rules.allowed[static_cast<std::size_t>(row.mode)] = true;
      if (!start) start = row.mode;
    }
  }
  if (!any && !start) {
    any = true;
    start = NavigationMode::walk;
  }
  if (any) rules.allowed.fill(true);
  rules.any = any;
  rules.start = start.value_or(NavigationMode::examine);
  return rules;
}

NavigationRules default_navigation_rules(const WideBox& bounds, bool has_viewpoint) {
  NavigationRules rules;
  rules.allowed.fill(true);
  rules.start = has_viewpoint ? NavigationMode::walk : NavigationMode::examine;
  const float size = bounds.empty() ? 0.0f : glm::length(bounds.size());
  if (std::isfinite(size) && size > 0) {
    rules.speed = size / 8;
    // In a small model, of a few centimetres for example, shrink the avatar.
    const double part = std::min(1.0, double{size} / kSizesOfAvatar / rules.avatar.height);
    rules.avatar.radius *= part;
    rules.avatar.height *= part;
    rules.avatar.step *= part;
  }
  return rules;
}

Drag drag_of(NavigationMode mode, DragButton button, bool modified) {
  const bool left = button == DragButton::left;
  const bool right = button == DragButton::right;
  switch (mode) {
    case NavigationMode::none:
      return Drag::none;
    case NavigationMode::examine:
    case NavigationMode::look_at:
      if (left) return modified ? Drag::pan : Drag::rotate;
      return modified ? Drag::zoom : Drag::pan;
    case NavigationMode::pan:
      if (left) return modified ? Drag::zoom : Drag::pan;
      return right ? Drag::pan : Drag::zoom;
    case NavigationMode::fly:
    case NavigationMode::walk:
      if (left) return modified ? Drag::pan : Drag::travel;
      return right ? Drag::look : Drag::pan;
  }
  return Drag::none;
}

std::vector<std::size_t> listed_viewpoints(const std::vector<render::ViewpointState>& viewpoints,
                                           const glm::dvec3& viewer) {
  std::vector<std::size_t> listed;
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    if (viewpoints[i].listed && (i == 0 || !viewpoints[i].description.empty()) &&
        is_around(viewpoints[i].regions, viewer))
      listed.push_back(i);
  return listed;
}

std::string viewpoint_label(const render::ViewpointState& viewpoint, std::size_t index) {
  if (!viewpoint.description.empty()) return viewpoint.group + viewpoint.description;
  if (!viewpoint.name.empty()) return viewpoint.group + viewpoint.name;
  return viewpoint.group + "Viewpoint " + std::to_string(index + 1);
}

std::string viewpoint_list(const std::vector<render::ViewpointState>& viewpoints) {
  if (viewpoints.empty()) return "the world has none";
  std::string text = "the world has";
  for (std::size_t i = 0; i < viewpoints.size() && i < 20; ++i)
    text += (i ? ", " : " ") + std::to_string(i + 1) + " '" + viewpoint_label(viewpoints[i], i) + "'";
  return text;
}

std::optional<std::size_t> find_viewpoint(const std::vector<render::ViewpointState>& viewpoints,
                                          std::string_view name) {
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    if (viewpoints[i].description == name || viewpoints[i].name == name) return i;
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size() || number < 1 || number > viewpoints.size())
    return std::nullopt;
  return number - 1;
}

}  // namespace gs::app
