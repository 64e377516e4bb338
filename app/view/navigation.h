#pragma once

#include "app/formats/common/upright.h"
#include "app/view/pose.h"
#include "app/view/walking.h"
#include "render/scene/camera.h"
#include "render/scene/render_list.h"
#include "vrml/mesh/mesh.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Maximum distance of a pose from the origin in metres. Beyond it, double precision cannot resolve a metre.
inline constexpr double kFarthest = 1e15;

/// Navigation mode (VRML97 6.29). `look_at` is from X3D: it turns the view as `examine` does, and a click moves the
/// viewer to the clicked object. `pan` is an addition of GhostSpace.
enum class NavigationMode : std::uint8_t { none, examine, fly, walk, pan, look_at };
inline constexpr int kNavigationModeCount = 6;

/// Row of the table of navigation modes.
struct NavigationModeRow {
  NavigationMode mode;
  std::string_view type;  // name in NavigationInfo.type; "" if no standard defines it
  std::string_view label;
  std::string_view help;
};
[[nodiscard]] const std::array<NavigationModeRow, kNavigationModeCount>& navigation_modes();
[[nodiscard]] const NavigationModeRow& row_of(NavigationMode mode);

/// Restrictions on navigation by the bound NavigationInfo of a world.
struct NavigationRules {
  NavigationMode start = NavigationMode::walk;
  std::array<bool, kNavigationModeCount> allowed{};  // by NavigationMode
  bool any = true;  // the types include ANY, so moves to Viewpoints may be animated
  float speed = 1;  // metres/s
  Avatar avatar;  // sizes in coordinates of the bound Viewpoint

  [[nodiscard]] bool allows(NavigationMode mode) const { return allowed[static_cast<std::size_t>(mode)]; }
};

/// Converts a NavigationInfo to rules (VRML97 6.29). The first known type is the start mode. Only the listed types are
/// allowed; ANY allows all modes. Unknown types are ignored. If no type is known, the default types WALK and ANY apply.
[[nodiscard]] NavigationRules navigation_rules(const render::NavigationState& navigation);
/// Returns the rules of a world without a NavigationInfo. All modes are allowed, and the speed crosses `bounds` in
/// about eight seconds. The start mode is WALK, the default of the standard, if the author defined a Viewpoint;
/// otherwise it is EXAMINE.
[[nodiscard]] NavigationRules default_navigation_rules(const WideBox& bounds, bool has_viewpoint);

/// Returns a valid pose: replaces numbers of `pose` that are not finite by those of `otherwise`, and limits the others
/// to their ranges.
[[nodiscard]] Pose valid_pose(Pose pose, const Pose& otherwise);
/// Returns the valid pose that is closest to a matrix. Removes scale and shear, and replaces NaN and infinity.
[[nodiscard]] Pose pose_of(const glm::dmat4& world_from_camera, float field_of_view);
[[nodiscard]] render::Camera camera_of(const Pose& pose);
/// Returns the transformation from viewer space to world space. It has no scale.
[[nodiscard]] glm::dmat4 world_from_viewer(const Pose& pose);

inline constexpr double kParallelReach = 1024;
/// Returns the width of a pixel at distance 1 along the ray through it, in a viewport of `size` pixels.
[[nodiscard]] float pixel_along_ray(const Pose& pose, const glm::vec2& size);
/// Changes a pose to parallel or perspective projection. Objects at `distance` from the viewer keep their size in the
/// picture.
[[nodiscard]] Pose with_parallel_rays(Pose pose, bool parallel, double distance);

/// Half-line in world space. `direction` has unit length.
struct Ray {
  glm::dvec3 origin{0};
  glm::vec3 direction{0, 0, -1};
  [[nodiscard]] glm::dvec3 at(double distance) const { return origin + glm::dvec3(direction) * distance; }
};
/// Returns the ray through `pointer`, which is in pixels from the upper left of a viewport of `size` pixels. In a
/// parallel projection, rays begin kParallelReach times the height behind the viewer, because objects there are
/// visible, too.
[[nodiscard]] Ray ray_through(const Pose& pose, const glm::vec2& pointer, const glm::vec2& size);

/// Projects the world point `place` to pixels from the upper left of a viewport of `size` pixels. Returns nullopt if
/// the point is behind a viewer with perspective projection.
[[nodiscard]] std::optional<glm::vec2> pixel_that_sees(const Pose& pose, const glm::dvec3& place,
                                                       const glm::vec2& size);

/// target_of() returns the world point on which a gesture acts: the point on the ray at the distance `hit`. If `hit` is
/// nullopt, it returns the point on the ray at the distance of the EXAMINE centre.
struct Navigation;
[[nodiscard]] glm::dvec3 target_of(const Navigation& state, const Ray& ray, std::optional<float> hit);

/// Effect of dragging with a button.
enum class Drag : std::uint8_t { none, rotate, pan, zoom, look, travel };
enum class DragButton : std::uint8_t { left, right, middle };
/// Returns the effect of dragging with a button. `modified` means that Shift or Control is held.
[[nodiscard]] Drag drag_of(NavigationMode mode, DragButton button, bool modified);

/// User input since the last step.
struct NavigationInput {
  glm::vec2 viewport{1024, 768};  // pixels; size of the viewport
  Drag drag = Drag::none;
  glm::vec2 moved{0};  // pixels, y down; pointer movement since the last step
  glm::vec2 from_press{0};  // pixels, y down; distance of the pointer from where the button was pressed
  std::optional<glm::dvec3> target;  // world point under the pointer, for zooming and panning
  float zoom = 0;  // wheel notches; positive moves the viewer closer
  glm::vec3 move{0};                 // held keys, -1..1: right, up, forward
  glm::vec2 turn{0};                 // held keys, -1..1: right, up
  bool fast = false;                 // Shift is held

  [[nodiscard]] bool any() const {
    return drag != Drag::none || zoom != 0 || move != glm::vec3(0) || turn != glm::vec2(0);
  }
};

/// Animated movement of the viewer from one pose to another.
struct Transition {
  Pose from, to;
  float elapsed = 0, duration = 0.4f;  // seconds
  bool jump = false;  // requested by the world: user input completes it (6.53) instead of stopping it
};

/// State of navigation. step() computes the next state from it.
struct Navigation {
  NavigationMode mode = NavigationMode::examine;
  Pose pose;
  glm::dvec3 center{0};  // world space; centre of rotation in EXAMINE
  glm::vec3 up{0, 1, 0};  // world space, unit length; the viewer's up direction (6.29)
  float scene_size = 10;  // metres, > 0; diameter of the scene
  float speed = 1;  // metres/s
  glm::vec3 velocity{0};  // speed by keys after smoothing: right, up, forward; 1 is full speed
  glm::vec2 turning{0};  // rotation by keys after smoothing: right, up; 1 is full speed
  float zoom_left = 0;  // wheel notches that are still pending
  glm::dvec3 zoom_target{0};
  std::optional<Transition> transition;
  Walk body;  // state of the body between steps; its position follows from `pose`
  bool ghost = false;  // true turns collision and gravity off

  /// Reports whether the pose will change without further input.
  [[nodiscard]] bool moving() const;
};

/// Returns the initial state for a world with these bounds and a viewer at `pose`.
[[nodiscard]] Navigation start_navigation(const NavigationRules& rules, const WideBox& bounds, const Pose& pose);

/// Returns the state after `seconds`. Pure. The length of steps affects the result only by rounding, and to second
/// order if turning and moving combine. Limits `seconds` to 0.25, so that a slow frame does not throw the viewer out of
/// the world.
[[nodiscard]] Navigation step(const Navigation& state, const NavigationInput& input, float seconds);

/// Applies collision and gravity to the movement from `before` to `after`, which is a result of step() (VRML97 4.13.4,
/// 6.29). In WALK and FLY, the viewer does not pass through `obstacles`; in WALK, the viewer also stays on the ground.
/// Gravity starts with the first movement, so that a world begins as its Viewpoint shows it. Transitions to a Viewpoint
/// have no gravity.
[[nodiscard]] Navigation with_body(const Navigation& before, Navigation after, const Avatar& avatar,
                                   const Obstacles& obstacles, float seconds);

/// Changes the mode and stops the current movement.
[[nodiscard]] Navigation with_mode(Navigation state, NavigationMode mode);
/// Starts an animated transition of 0.4 s to `pose`. User input ends it. For `jump`, see Transition.
[[nodiscard]] Navigation travel_to(Navigation state, const Pose& pose, bool jump = false);
/// Starts a transition to a level pose that shows all of an object with these bounds. The viewer stays on the present
/// side of the object. If the viewer is inside the bounds, moves closer to `point` instead. The new EXAMINE centre is
/// the centre of the bounds, or `point` if the viewer is inside.
[[nodiscard]] Navigation approach(Navigation state, const glm::dvec3& point, const WideBox& bounds,
                                  const glm::vec2& viewport);
/// Starts a transition that turns the viewer towards `point` and moves it halfway there. The point becomes the EXAMINE
/// centre.
[[nodiscard]] Navigation seek(Navigation state, const glm::dvec3& point);
/// Returns the distance to the point at which the viewer looks, in world units; never 0.
[[nodiscard]] double looked_at_distance(const Navigation& state);
/// Makes `point` the EXAMINE centre, and slides the viewer until the point is in the middle of the picture.
[[nodiscard]] Navigation look_at_point(Navigation state, const glm::dvec3& point);
/// Returns render::orbit_camera() for an object with an up axis: azimuth 0 and elevation 0 look at its front.
[[nodiscard]] render::Camera orbit_camera_of(const WideBox& bounds, float azimuth, float elevation, float field_of_view,
                                             const glm::vec2& viewport, const Upright& upright);
/// Returns the height of a parallel projection by which `camera` shows all of `bounds`, with a margin.
[[nodiscard]] double fitting_height(const render::Camera& camera, const WideBox& bounds, const glm::vec2& viewport);
/// Returns a pose that shows all of `bounds` along the view direction of `pose`, level with respect to `up`.
[[nodiscard]] Pose pose_that_fits(const Pose& pose, const WideBox& bounds, const glm::vec2& viewport,
                                  const glm::vec3& up = {0, 1, 0});
/// Returns the height of a parallel projection that shows a rectangle of this size in a viewport.
[[nodiscard]] double height_that_shows(const glm::dvec2& extent, const glm::vec2& viewport);
/// Side of an object from the position of a viewer in front of it: `left` is at the viewer's left.
enum class ViewSide : std::uint8_t { front, back, left, right, top, bottom };
inline constexpr int kSideCount = 6;
/// Returns a pose that shows all of `bounds` from one side, with the field of view of `pose`.
[[nodiscard]] Pose pose_at_side(ViewSide side, const Pose& pose, const WideBox& bounds, const glm::vec2& viewport,
                                const Upright& upright);
/// Removes the roll from `pose`. Returns it unchanged if the view direction is vertical.
[[nodiscard]] Pose straightened(const Pose& pose, const glm::vec3& up);
/// Returns the camera of the bound Viewpoint. If that is not in the list, for example because a Switch hides it,
/// returns the camera of the first Viewpoint. Without Viewpoints, returns a camera that shows the whole world in a
/// picture of `size` pixels.
[[nodiscard]] render::Camera viewpoint_camera(const render::RenderList& list, const vrml::Node* bound,
                                              const glm::vec2& size);
/// Returns the initial pose in a world without a Viewpoint: it shows the whole world from the front.
[[nodiscard]] Pose first_pose(const WideBox& bounds, const glm::vec2& viewport, const Upright& upright = {});

/// Returns the indices of the Viewpoints that the user can choose: those with a description, and the first one, which
/// is bound at the start (VRML97 6.53). Omits those of ViewpointGroups that are not displayed, or that have a box which is not
/// around `viewer`, a position in world space.
[[nodiscard]] std::vector<std::size_t> listed_viewpoints(const std::vector<render::ViewpointState>& viewpoints,
                                                         const glm::dvec3& viewer = glm::dvec3(0));
/// Returns the description of a Viewpoint; if it is empty, the DEF name; if there is none, the number from 1. The
/// descriptions of its ViewpointGroups precede it.
[[nodiscard]] std::string viewpoint_label(const render::ViewpointState& viewpoint, std::size_t index);
/// Returns a list of all Viewpoints for messages, such as "the world has 1 'Front', 2 'Back'".
[[nodiscard]] std::string viewpoint_list(const std::vector<render::ViewpointState>& viewpoints);
/// Returns the index of the Viewpoint with this description or DEF name, or with this number, counted from 1.
[[nodiscard]] std::optional<std::size_t> find_viewpoint(const std::vector<render::ViewpointState>& viewpoints,
                                                        std::string_view name);

}  // namespace gs::app
