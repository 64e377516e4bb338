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

/// Metres from the origin that a pose can hold: beyond, doubles have no metres left.
inline constexpr double kFarthest = 1e15;

/// How the user moves through the world (VRML97 6.29). `pan` is ours; in `look_at`, which later browsers brought, he
/// turns things as in `examine`, and a click leads him to one.
enum class NavigationMode : std::uint8_t { none, examine, fly, walk, pan, look_at };
inline constexpr int kNavigationModeCount = 6;

/// One row of the table of modes.
struct NavigationModeRow {
  NavigationMode mode;
  std::string_view type;  // in NavigationInfo.type; "" where no standard has it
  std::string_view label;
  std::string_view help;
};
[[nodiscard]] const std::array<NavigationModeRow, kNavigationModeCount>& navigation_modes();
[[nodiscard]] const NavigationModeRow& row_of(NavigationMode mode);

/// What the world allows, from the bound NavigationInfo.
struct NavigationRules {
  NavigationMode start = NavigationMode::walk;
  std::array<bool, kNavigationModeCount> allowed{};  // by NavigationMode
  bool any = true;                                   // ANY is listed: ways to Viewpoints may be animated
  float speed = 1;                                   // metres a second
  Avatar avatar;                                     // of the bound Viewpoint's coordinates

  [[nodiscard]] bool allows(NavigationMode mode) const { return allowed[static_cast<std::size_t>(mode)]; }
};

/// VRML97 6.29: the first recognised type is where to start, only listed types are allowed, ANY allows
/// all. Unknown types are skipped; a list of nothing else counts as the default, WALK and ANY.
[[nodiscard]] NavigationRules navigation_rules(const render::NavigationState& navigation);
/// For a world without a NavigationInfo: everything is allowed, and the speed crosses `bounds` in about
/// eight seconds. Starts as the standard's default does when the author chose a Viewpoint, else in EXAMINE.
[[nodiscard]] NavigationRules default_navigation_rules(const render::WorldBounds& bounds, bool has_viewpoint);

/// With all numbers finite and in their ranges; those of `otherwise` where that cannot be.
[[nodiscard]] Pose valid_pose(Pose pose, const Pose& otherwise);
/// The nearest valid pose: scale and shear of the matrix are taken out, NaN and infinity replaced.
[[nodiscard]] Pose pose_of(const glm::dmat4& world_from_camera, float field_of_view);
[[nodiscard]] render::Camera camera_of(const Pose& pose);
/// Without scale.
[[nodiscard]] glm::dmat4 world_from_viewer(const Pose& pose);

inline constexpr double kParallelReach = 1024;
/// How wide a pixel is a unit along such a ray, in a viewport of `size` pixels.
[[nodiscard]] float pixel_along_ray(const Pose& pose, const glm::vec2& size);
/// The same seen by parallel rays, or in perspective: what is `distance` ahead is as large as before.
[[nodiscard]] Pose with_parallel_rays(Pose pose, bool parallel, double distance);

/// A half line of world space; `direction` is of unit length.
struct Ray {
  glm::dvec3 origin{0};
  glm::vec3 direction{0, 0, -1};
  [[nodiscard]] glm::dvec3 at(double distance) const { return origin + glm::dvec3(direction) * distance; }
};
/// The ray through `pointer`, in pixels from the upper left of a viewport of `size` pixels. Parallel ones begin
/// kParallelReach heights behind the viewer, since he sees what is there, too.
[[nodiscard]] Ray ray_through(const Pose& pose, const glm::vec2& pointer, const glm::vec2& size);

/// A pixel of a viewport of `size` pixels that sees the place, from its upper left; none: it is behind the viewer.
[[nodiscard]] std::optional<glm::vec2> pixel_that_sees(const Pose& pose, const glm::dvec3& place,
                                                       const glm::vec2& size);

/// The world point that a gesture under the pointer is about: what the pointer's ray hits, `hit` metres away,
/// else a point as far away as what EXAMINE turns about.
struct Navigation;
[[nodiscard]] glm::dvec3 target_of(const Navigation& state, const Ray& ray, std::optional<float> hit);

/// What a drag with a button does.
enum class Drag : std::uint8_t { none, rotate, pan, zoom, look, travel };
enum class DragButton : std::uint8_t { left, right, middle };
/// `modified`: Shift or Control is held.
[[nodiscard]] Drag drag_of(NavigationMode mode, DragButton button, bool modified);

/// What the user did since the last step.
struct NavigationInput {
  glm::vec2 viewport{1024, 768};  // pixels
  Drag drag = Drag::none;
  glm::vec2 moved{0};                // the pointer since the last step, pixels, y down
  glm::vec2 from_press{0};           // the pointer from where the button went down, pixels, y down
  std::optional<glm::dvec3> target;  // world point under the pointer, for zoom and pan
  float zoom = 0;                    // wheel notches, positive goes closer
  glm::vec3 move{0};                 // held keys, -1..1: right, up, forward
  glm::vec2 turn{0};                 // held keys, -1..1: right, up
  bool fast = false;                 // Shift is held

  [[nodiscard]] bool any() const {
    return drag != Drag::none || zoom != 0 || move != glm::vec3(0) || turn != glm::vec2(0);
  }
};

/// A way from one pose to another.
struct Transition {
  Pose from, to;
  float elapsed = 0, duration = 0.4f;  // seconds
  bool jump = false;                   // of the world: who moves meanwhile is there at once (6.53), not left on the way
};

/// Everything that navigation remembers. A plain value; `step` makes the next one from it.
struct Navigation {
  NavigationMode mode = NavigationMode::examine;
  Pose pose;
  glm::dvec3 center{0};   // what EXAMINE turns about
  glm::vec3 up{0, 1, 0};  // of the world, for the viewer; of length 1 (6.29)
  float scene_size = 10;  // metres across; > 0
  float speed = 1;        // metres a second
  glm::vec3 velocity{0};  // of the keys, smoothed: right, up, forward; 1 is full speed
  glm::vec2 turning{0};   // likewise: right, up
  float zoom_left = 0;    // notches of the wheel still to be gone
  glm::dvec3 zoom_target{0};
  std::optional<Transition> transition;
  Walk body;           // what it keeps from step to step; where it is follows from `pose`
  bool ghost = false;  // goes through everything, and does not fall

  /// True while the view changes by itself.
  [[nodiscard]] bool moving() const;
};

/// A Navigation for a world of these bounds, with its viewer at `pose`.
[[nodiscard]] Navigation start_navigation(const NavigationRules& rules, const render::WorldBounds& bounds,
                                          const Pose& pose);

/// The state `seconds` later. Pure, and independent of how a span of time is cut into steps up to rounding
/// (paths that turn and move at once: to second order). `seconds` counts as at most a quarter second, so
/// that a stalled frame throws nobody out of the world.
[[nodiscard]] Navigation step(const Navigation& state, const NavigationInput& input, float seconds);

/// The step from `before` to `after`, which `step` made, for one who has a body: who walks or flies does not go through
/// `obstacles`, and who walks stands on the ground (VRML97 4.13.4, 6.29). Who has not moved yet does not fall, so that
/// worlds begin as their Viewpoints see them; nor does who is on the way to a Viewpoint.
[[nodiscard]] Navigation with_body(const Navigation& before, Navigation after, const Avatar& avatar,
                                   const Obstacles& obstacles, float seconds);

/// Changes the mode and stops what the old one was doing.
[[nodiscard]] Navigation with_mode(Navigation state, NavigationMode mode);
/// Starts a smooth way (0.4 s) to `pose`, which ends where the user moves; `jump`: see Transition.
[[nodiscard]] Navigation travel_to(Navigation state, const Pose& pose, bool jump = false);
/// Starts a way to where a thing that fills `bounds`, of which `point` is seen, fills most of the picture: looking at
/// it from the present side, level. Who is inside of `bounds` goes nearer to the point. It is what EXAMINE turns about
/// then.
[[nodiscard]] Navigation approach(Navigation state, const glm::dvec3& point, const render::WorldBounds& bounds,
                                  const glm::vec2& viewport);
/// Starts a way to half the distance of `point`, looking at it; it is what EXAMINE turns about then.
[[nodiscard]] Navigation seek(Navigation state, const glm::dvec3& point);
/// How far away what the viewer looks at is, in world units; never 0.
[[nodiscard]] double looked_at_distance(const Navigation& state);
/// Makes `point` what EXAMINE turns about, and slides the view until it is in the middle.
[[nodiscard]] Navigation look_at_point(Navigation state, const glm::dvec3& point);
/// render::orbit_camera of what stands upright: azimuth and elevation 0 look from its front.
[[nodiscard]] render::Camera orbit_camera_of(const render::WorldBounds& bounds, float azimuth, float elevation,
                                             float field_of_view, const glm::vec2& viewport, const Upright& upright);
/// The height by which parallel rays from there have the whole of `bounds` in view, with some air.
[[nodiscard]] double fitting_height(const render::Camera& camera, const render::WorldBounds& bounds,
                                    const glm::vec2& viewport);
/// Where the whole of `bounds` is seen from the present direction, level where `up` is up.
[[nodiscard]] Pose pose_that_fits(const Pose& pose, const render::WorldBounds& bounds, const glm::vec2& viewport,
                                  const glm::vec3& up = {0, 1, 0});
/// The sides that a thing has, as who stands in front of it names them: its left is to his left.
enum class ViewSide : std::uint8_t { front, back, left, right, top, bottom };
inline constexpr int kSideCount = 6;
/// Where the whole of `bounds` is seen from one of its sides, with the lens of `pose`.
[[nodiscard]] Pose pose_at_side(ViewSide side, const Pose& pose, const render::WorldBounds& bounds,
                                const glm::vec2& viewport, const Upright& upright);
/// The same place and direction without roll; straight up or down nothing is turned.
[[nodiscard]] Pose straightened(const Pose& pose, const glm::vec3& up);
/// The camera of the bound Viewpoint; of the first one where that is not shown, inside a Switch for example; of a world
/// without any, one that has the whole in view in a picture of this size.
[[nodiscard]] render::Camera viewpoint_camera(const render::RenderList& list, const vrml::Node* bound,
                                              const glm::vec2& size);
/// Where a world without a Viewpoint is first seen from: all of it, from the front.
[[nodiscard]] Pose first_pose(const render::WorldBounds& bounds, const glm::vec2& viewport,
                              const Upright& upright = {});

/// The Viewpoints that a list for the user has: those with a description, and the first, which is bound at
/// start (VRML97 6.53). Indices into `viewpoints`.
[[nodiscard]] std::vector<std::size_t> listed_viewpoints(const std::vector<render::ViewpointState>& viewpoints);
/// What to call it: its description, else its DEF name, else its number.
[[nodiscard]] std::string viewpoint_label(const render::ViewpointState& viewpoint, std::size_t index);
/// For messages: "the world has 1 'Front', 2 'Back'".
[[nodiscard]] std::string viewpoint_list(const std::vector<render::ViewpointState>& viewpoints);
/// The Viewpoint with this description or DEF name, else with this number, counted from 1.
[[nodiscard]] std::optional<std::size_t> find_viewpoint(const std::vector<render::ViewpointState>& viewpoints,
                                                        std::string_view name);

}  // namespace gs::app
