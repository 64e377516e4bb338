#include "app/session/navigation/viewer_motion.h"

#include "vrml/behaviours/browser_events.h"

#include <glm/gtc/quaternion.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace gs::app {
namespace {

constexpr std::size_t kMaxMet = 20'000;                       // max triangles near a moving viewer
constexpr std::size_t kMaxRemembered = std::size_t{1} << 24;  // max triangles that the picker stores

// Returns the ellipsoid below the viewer of a view that moves over it; null without a GeoViewpoint.
const vrml::GeoGround* ground_of(const View& seen) {
  const NavigationMode mode = seen.navigation.mode;
  if (!seen.viewpoint || *seen.viewpoint >= seen.list->viewpoints.size() ||
      (mode != NavigationMode::fly && mode != NavigationMode::walk))
    return nullptr;
  const auto& ground = seen.list->viewpoints[*seen.viewpoint].ground;
  return ground ? &*ground : nullptr;
}

// Returns the state after a step. Above an ellipsoid, the speed grows with the elevation (X3D 25.3.11).
Navigation step_over(const View& seen, const NavigationInput& input, float seconds) {
  const vrml::GeoGround* const ground = ground_of(seen);
  if (!ground) return app::step(seen.navigation, input, seconds);
  Navigation scaled = seen.navigation;
  scaled.speed = static_cast<float>(scaled.speed * ground->speed(scaled.pose.position));
  Navigation next = app::step(scaled, input, seconds);
  next.speed = seen.navigation.speed;
  return next;
}

// Turns the viewer after a movement over an ellipsoid, so that the horizon stays level.
void turn_with_ground(View& seen, const glm::dvec3& from) {
  Navigation& navigation = seen.navigation;
  const vrml::GeoGround* const ground = ground_of(seen);
  if (!ground || seen.style.up != UpAxis::automatic || from == navigation.pose.position || navigation.transition)
    return;
  const glm::dvec3 before = ground->up(from), after = ground->up(navigation.pose.position);
  const double cosine = glm::dot(before, after);
  if (!(cosine > 0)) return;
  const glm::dquat turn = glm::normalize(glm::dquat(1 + cosine, glm::cross(before, after)));
  navigation.pose.orientation = glm::normalize(glm::quat(turn * glm::dquat(navigation.pose.orientation)));
  navigation.up = glm::vec3(after);
}

}  // namespace

// Moves the viewer to `after`, but not through obstacles.
void ViewerMotion::move(View& seen, Navigation after, bool loading, float seconds) {
  const render::RenderList& list = *seen.list;
  Obstacles obstacles;
  obstacles.near = [&](const glm::dvec3& lower, const glm::dvec3& upper) {
    return picker_.items().near(list, lower, upper, kMaxMet);
  };
  obstacles.distance = [&](const glm::dvec3& origin, const glm::dvec3& direction) -> std::optional<double> {
    const auto hit = picker_.items().nearest(list, {origin, direction}, kMaxRemembered, render::Sought::met);
    return hit ? std::optional(hit->triangle.distance) : std::nullopt;
  };
  Avatar avatar = seen.rules.avatar;
  avatar.radius *= seen.scale;
  avatar.height *= seen.scale;
  avatar.step *= seen.scale;
  avatar.gravity = !loading;  // not while loading, because the ground may be missing
  if (seen.document->runtime) {
    const vrml::BrowserSettings& settings = seen.document->runtime->execution().browser().settings();
    avatar.gravity = avatar.gravity && settings.gravity;
    avatar.solid = settings.collision;
  }
  const std::optional<std::size_t> before = seen.navigation.body.item;
  seen.navigation = with_body(seen.navigation, std::move(after), avatar, obstacles, seconds);
  const std::optional<std::size_t> met = seen.navigation.body.item;
  if (!met || !seen.document->runtime) return;
  Hit hit;
  hit.item = *met;
  (void)vrml::collide(seen.document->runtime->execution(), path_of(list, hit),
                      met == before ? vrml::Meeting::lasts : vrml::Meeting::begins);
}

std::vector<std::size_t> ViewerMotion::advance(float seconds, bool look) {
  Panes& panes = viewports_.panes();
  const std::vector<std::size_t> sight = panes.visible();
  const std::vector<Viewport> rectangles = viewports_.places();
  std::vector<std::size_t> moved;
  for (std::size_t i = 0; i < sight.size(); ++i) {
    Pane& pane = panes.at(sight[i]);
    View* seen = pane.view();
    if (!seen) continue;
    const Pose before = seen->navigation.pose;
    const NavigationInput input = pane.input.input(seen->navigation.mode, rectangles[i]);
    if (input.any()) {
      viewports_.lead(sight[i]);
      seen->history.interrupt();
    }
    move(*seen, step_over(*seen, input, seconds), panes.loading(sight[i]), seconds);
    turn_with_ground(*seen, before.position);
    const Pose& after = seen->navigation.pose;
    if (before.position == after.position && before.orientation == after.orientation && before.height == after.height)
      continue;
    seen->history.moved(before, after, step_.now);
    moved.push_back(sight[i]);
    step_.frame.changed = true;
  }
  if (viewports_.linked() && !moved.empty()) link(moved);
  if (look)
    for (const std::size_t i : sight)
      if (View* seen = panes.at(i).view()) (void)follow_world(*seen);
  return moved;
}

// Applies the camera of one viewer that moved to all linked viewports. Prefers the leader, then the active viewport.
void ViewerMotion::link(std::span<const std::size_t> moved) {
  const auto has_moved = [&](std::size_t pane) { return std::find(moved.begin(), moved.end(), pane) != moved.end(); };
  const std::size_t leader = viewports_.leader(), active = viewports_.panes().active();
  viewports_.panes().link(has_moved(leader) ? leader : has_moved(active) ? active : moved.front());
}

bool ViewerMotion::moving() const {
  for (const std::size_t i : viewports_.panes().visible()) {
    const Pane& pane = viewports_.panes().at(i);
    const View* seen = pane.view();
    if (seen && (seen->navigation.moving() || pane.input.holding())) return true;
  }
  return false;
}

}  // namespace gs::app
