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

/// Maximum distance of a pose from the origin in metres; beyond it, doubles cannot resolve a metre.
inline constexpr double kFarthest = 1e15;

/// Navigation mode (VRML97 6.29). `pan` is an addition of GhostSpace. `look_at` (X3D) turns the view as `examine` does;
/// a click moves to the clicked object.
enum class NavigationMode : std::uint8_t { none, examine, fly, walk, pan, look_at };
inline constexpr int kNavigationModeCount = 6;

/// Row of the table of modes.
struct NavigationModeRow {
  NavigationMode mode;
  std::string_view type;  // name in NavigationInfo.type; "" if no standard defines it
  std::string_view label;
  std::string_view help;
};
[[nodiscard]] const std::array<NavigationModeRow, kNavigationModeCount>& navigation_modes();
[[nodiscard]] const NavigationModeRow& row_of(NavigationMode mode);

/// Navigation limits of the world, from the bound NavigationInfo.
struct NavigationRules {
  NavigationMode start = NavigationMode::walk;
  std::array<bool, kNavigationModeCount> allowed{};  // indexed by NavigationMode
  bool any = true;                                   // ANY is listed, so transitions to Viewpoints may be animated
  float speed = 1;                                   // metres per second
  Avatar avatar;                                     // in coordinates of the bound Viewpoint

  [[nodiscard]] bool allows(NavigationMode mode) const { return allowed[static_cast<std::size_t>(mode)]; }
};

/// Converts a NavigationInfo (VRML97 6.29). The first recognised type is the start mode; only listed types are allowed;
/// ANY allows all. Unknown types are skipped. A list without known types means the default, WALK and ANY.
[[nodiscard]] NavigationRules navigation_rules(const render::NavigationState& navigation);
/// Returns the rules for a world without NavigationInfo: all modes, at a speed that crosses `bounds` in about eight
/// seconds. Starts in the standard's default mode if the author defined a Viewpoint, else in EXAMINE.
[[nodiscard]] NavigationRules default_navigation_rules(const WideBox& bounds, bool has_viewpoint);

/// Returns `pose` with finite numbers in their ranges; uses parts of `otherwise` where needed.
[[nodiscard]] Pose valid_pose(Pose pose, const Pose& otherwise);
/// Returns the nearest valid pose to a matrix. Removes scale and shear; replaces NaN and infinity.
[[nodiscard]] Pose pose_of(const glm::dmat4& world_from_camera, float field_of_view);
[[nodiscard]] render::Camera camera_of(const Pose& pose);
/// Returns the transform without scale.
[[nodiscard]] glm::dmat4 world_from_viewer(const Pose& pose);

inline constexpr double kParallelReach = 1024;
/// Returns the width of a pixel at distance 1 along a pixel's ray, in a viewport of `size` pixels.
[[nodiscard]] float pixel_along_ray(const Pose& pose, const glm::vec2& size);
/// Switches between parallel and perspective projection; content at `distance` keeps its size on screen.
[[nodiscard]] Pose with_parallel_rays(Pose pose, bool parallel, double distance);

/// Half line in world space; `direction` has unit length.
struct Ray {
  glm::dvec3 origin{0};
  glm::vec3 direction{0, 0, -1};
  [[nodiscard]] glm::dvec3 at(double distance) const { return origin + glm::dvec3(direction) * distance; }
};
/// Returns the ray through `pointer`, in pixels from the upper left of a viewport of `size` pixels. Parallel rays begin
/// kParallelReach heights behind the viewer, because content there is visible, too.
[[nodiscard]] Ray ray_through(const Pose& pose, const glm::vec2& pointer, const glm::vec2& size);

/// Projects `place` to pixels from the upper left of a viewport of `size` pixels. Returns nullopt if it is behind the
/// viewer.
[[nodiscard]] std::optional<glm::vec2> pixel_that_sees(const Pose& pose, const glm::dvec3& place,
                                                       const glm::vec2& size);

/// Returns the world point for a gesture under the pointer: the hit of the pointer's ray, `hit` metres away. Without a
/// hit, returns a point on the ray as far away as the EXAMINE centre.
struct Navigation;
[[nodiscard]] glm::dvec3 target_of(const Navigation& state, const Ray& ray, std::optional<float> hit);

/// Effect of a drag with a button.
enum class Drag : std::uint8_t { none, rotate, pan, zoom, look, travel };
enum class DragButton : std::uint8_t { left, right, middle };
/// Returns the drag for a button. `modified` means that Shift or Control is held.
[[nodiscard]] Drag drag_of(NavigationMode mode, DragButton button, bool modified);

/// User input since the last step.
struct NavigationInput {
  glm::vec2 viewport{1024, 768};  // pixels
  Drag drag = Drag::none;
  glm::vec2 moved{0};                // pointer movement since the last step, pixels, y down
  glm::vec2 from_press{0};           // pointer offset from the press position, pixels, y down
  std::optional<glm::dvec3> target;  // world point under the pointer, for zoom and pan
  float zoom = 0;                    // wheel notches; positive moves closer
  glm::vec3 move{0};                 // held keys, -1..1: right, up, forward
  glm::vec2 turn{0};                 // held keys, -1..1: right, up
  bool fast = false;                 // Shift is held

  [[nodiscard]] bool any() const {
    return drag != Drag::none || zoom != 0 || move != glm::vec3(0) || turn != glm::vec2(0);
  }
};

/// Animated movement from one pose to another.
struct Transition {
  Pose from, to;
  float elapsed = 0, duration = 0.4f;  // seconds
  bool jump = false;                   // jump of the world: user input ends it at its goal (6.53), not on the way
};

/// Complete navigation state. A plain value; `step` computes the next one.
struct Navigation {
  NavigationMode mode = NavigationMode::examine;
  Pose pose;
  glm::dvec3 center{0};   // centre of rotation in EXAMINE
  glm::vec3 up{0, 1, 0};  // the viewer's up direction in world space, unit length (6.29)
  float scene_size = 10;  // diameter in metres; > 0
  float speed = 1;        // metres per second
  glm::vec3 velocity{0};  // smoothed key movement: right, up, forward; 1 is full speed
  glm::vec2 turning{0};   // smoothed key rotation: right, up
  float zoom_left = 0;    // wheel notches not yet applied
  glm::dvec3 zoom_target{0};
  std::optional<Transition> transition;
  Walk body;           // body state between steps; its position follows from `pose`
  bool ghost = false;  // collision and gravity are off

  /// Reports whether the view changes without input.
  [[nodiscard]] bool moving() const;
};

/// Returns the initial state for a world of size `bounds`, with the viewer at `pose`.
[[nodiscard]] Navigation start_navigation(const NavigationRules& rules, const WideBox& bounds, const Pose& pose);

/// Returns the state after `seconds`. Pure, and independent of the step size up to rounding (to second order if turning
/// and moving combine). Clamps `seconds` to 0.25, so that a stalled frame does not throw the viewer out of the world.
[[nodiscard]] Navigation step(const Navigation& state, const NavigationInput& input, float seconds);

/// Adds collision and gravity to the movement from `before` to `after`, a result of `step` (VRML97 4.13.4, 6.29). WALK
/// and FLY do not pass through `obstacles`; WALK keeps the viewer on the ground. Gravity starts with the first
/// movement, so that worlds begin as their Viewpoints show them. Transitions to a Viewpoint have no gravity.
[[nodiscard]] Navigation with_body(const Navigation& before, Navigation after, const Avatar& avatar,
                                   const Obstacles& obstacles, float seconds);

/// Changes the mode and stops the current movement.
[[nodiscard]] Navigation with_mode(Navigation state, NavigationMode mode);
/// Starts a smooth transition (0.4 s) to `pose`; user input ends it. For `jump` see Transition.
[[nodiscard]] Navigation travel_to(Navigation state, const Pose& pose, bool jump = false);
/// Starts a transition that frames an object of size `bounds`, seen at `point`, from the present side and level. From
/// inside `bounds`, moves closer to the point instead. The point becomes the EXAMINE centre.
[[nodiscard]] Navigation approach(Navigation state, const glm::dvec3& point, const WideBox& bounds,
                                  const glm::vec2& viewport);
/// Starts a transition to half the distance of `point`, facing it. The point becomes the EXAMINE centre.
[[nodiscard]] Navigation seek(Navigation state, const glm::dvec3& point);
/// Returns the distance to the point that the viewer looks at, in world units; never 0.
[[nodiscard]] double looked_at_distance(const Navigation& state);
/// Makes `point` the EXAMINE centre and slides the view until the point is centred.
[[nodiscard]] Navigation look_at_point(Navigation state, const glm::dvec3& point);
/// Returns render::orbit_camera for an upright object: azimuth 0 and elevation 0 look at its front.
[[nodiscard]] render::Camera orbit_camera_of(const WideBox& bounds, float azimuth, float elevation, float field_of_view,
                                             const glm::vec2& viewport, const Upright& upright);
/// Returns the height of a parallel projection from `camera` that shows all of `bounds`, with a margin.
[[nodiscard]] double fitting_height(const render::Camera& camera, const WideBox& bounds, const glm::vec2& viewport);
/// Returns a pose that shows all of `bounds` from the present direction, level with respect to `up`.
[[nodiscard]] Pose pose_that_fits(const Pose& pose, const WideBox& bounds, const glm::vec2& viewport,
                                  const glm::vec3& up = {0, 1, 0});
/// Side of an object as named by a viewer in front of it: `left` is on the viewer's left.
enum class ViewSide : std::uint8_t { front, back, left, right, top, bottom };
inline constexpr int kSideCount = 6;
/// Returns a pose that shows all of `bounds` from one side, with the field of view of `pose`.
[[nodiscard]] Pose pose_at_side(ViewSide side, const Pose& pose, const WideBox& bounds, const glm::vec2& viewport,
                                const Upright& upright);
/// Removes roll from `pose`. Leaves it unchanged if it looks straight up or down.
[[nodiscard]] Pose straightened(const Pose& pose, const glm::vec3& up);
/// Returns the camera of the bound Viewpoint, or of the first one if that is hidden, for example in a Switch. Without
/// Viewpoints, returns a camera that frames the world in a picture of this size.
[[nodiscard]] render::Camera viewpoint_camera(const render::RenderList& list, const vrml::Node* bound,
                                              const glm::vec2& size);
/// Returns the initial pose of a world without a Viewpoint: all of it, from the front.
[[nodiscard]] Pose first_pose(const WideBox& bounds, const glm::vec2& viewport, const Upright& upright = {});

/// Returns the indices of Viewpoints to list for the user: those with a description, and the first one, which is bound
/// at start (VRML97 6.53).
[[nodiscard]] std::vector<std::size_t> listed_viewpoints(const std::vector<render::ViewpointState>& viewpoints);
/// Returns the description of a Viewpoint, else its DEF name, else its number.
[[nodiscard]] std::string viewpoint_label(const render::ViewpointState& viewpoint, std::size_t index);
/// Lists the Viewpoints for messages: "the world has 1 'Front', 2 'Back'".
[[nodiscard]] std::string viewpoint_list(const std::vector<render::ViewpointState>& viewpoints);
/// Finds a Viewpoint by description or DEF name, else by its number, counted from 1.
[[nodiscard]] std::optional<std::size_t> find_viewpoint(const std::vector<render::ViewpointState>& viewpoints,
                                                        std::string_view name);

}  // namespace gs::app
