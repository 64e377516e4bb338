#pragma once

#include "vrml/event_model/behaviour.h"
#include "vrml/event_model/placement.h"
#include "vrml/scene/scene_graph.h"

#include <glm/gtc/quaternion.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <bitset>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::vrml {

/// Kind of a user's input, in the order of the bits of `eventMask`.
enum class BrowserInputKind : std::uint8_t {
  mousedown,
  mousemove,
  mouseout,
  mouseover,
  mouseup,
  keydown,
  keyup,
  keypress,
  click,
  dblclick,
};

/// Input of the user, as Contact describes it.
struct BrowserInput {
  BrowserInputKind kind = BrowserInputKind::keydown;
  int key = 0;     // key code of Windows; 0 means none
  int button = 0;  // 1 left, 2 right, 4 middle; 0 means none
  bool alt = false, control = false, shift = false;
  glm::vec2 client{0};  // pixels from the upper left of the viewport
};

/// Interfaces of the browser's node, as indices of Behaviour::events.
struct BrowserEvents {
  enum : int { event_mask, event_changed, position, orientation, window_size, window_aspect };
};

/// Viewport of a world, as programs see it.
struct BrowserView {
  glm::dvec2 size{0};  // pixels; 0 before there is a viewport
  std::string mode;    // navigation mode, as in NavigationInfo.type
  double speed = 1;    // metres/s; speed of navigation
};

/// Settings of navigation and sound that programs change. The user's own settings apply too.
struct BrowserSettings {
  bool collision = true, gravity = true, sound = true;
  bool viewpoint_animation = true;  // moves to Viewpoints take time
};

/// Result of a ray in a world.
struct RayHit {
  glm::dvec3 point{0}, normal{0};  // world space
  glm::vec2 texture_coordinate{0};
  std::vector<std::pair<const SceneGraph*, NodeId>> path;  // nodes from the root of the world to the Shape
};

/// The browser of a world: what programs and ROUTEs read of it, and what they ask of it. Part of Execution.
///
/// Requests of programs overwrite each other, so they need no queue. Whoever shows the world takes them once a step.
class WorldBrowser {
 public:
  /// Function that finds the nearest Shape on the line from `from` to `to`. If the scene of `below` is not null, only
  /// descendants of that node count.
  using RayCaster =
      std::function<std::optional<RayHit>(const glm::dvec3& from, const glm::dvec3& to, const NodePlace& below)>;

  explicit WorldBrowser(Execution& execution) : execution_(execution) {}

  void begin(double now) { start_time_ = now; }
  /// Returns the time at which the world started, in seconds since 1970.
  [[nodiscard]] double start_time() const { return start_time_; }

  void set_view(BrowserView view) { view_ = std::move(view); }
  [[nodiscard]] const BrowserView& view() const { return view_; }
  [[nodiscard]] BrowserSettings& settings() { return settings_; }
  [[nodiscard]] const BrowserSettings& settings() const { return settings_; }

  /// Requests a position or an orientation of the viewer in world space. Ignores numbers that are not finite.
  void move_viewer(const std::optional<glm::dvec3>& position, const std::optional<glm::dquat>& orientation);
  /// Returns world_from_viewer after the requests so far.
  [[nodiscard]] glm::dmat4 pose();
  /// Returns the requested world_from_viewer; nullopt without a request.
  [[nodiscard]] std::optional<glm::dmat4> take_move();
  /// Requests a navigation mode. Keeps the first characters of a long name.
  void choose_mode(std::string_view mode);
  /// Returns the requested mode, else the mode of the viewport.
  [[nodiscard]] const std::string& mode() const { return wanted_mode_ ? *wanted_mode_ : view_.mode; }
  [[nodiscard]] std::optional<std::string> take_mode() { return std::exchange(wanted_mode_, std::nullopt); }

  /// Sets the function that casts rays; see RayCaster. Points are in world space.
  void set_ray_caster(RayCaster caster) { caster_ = std::move(caster); }
  /// Returns the nearest Shape on a line. Returns nullopt if there is none, or if nobody shows the world.
  [[nodiscard]] std::optional<RayHit> cast_ray(const glm::dvec3& from, const glm::dvec3& to,
                                               const NodePlace& below = {}) const;

  /// Returns the browser as a node of a scene. Makes the node on the first call. Returns null if the budget is
  /// exhausted.
  [[nodiscard]] NodeId node_in(SceneGraph& scene);
  void add(EventNode node);
  void remove(EventNode node);
  /// Sends the changed values of the browser's nodes that another node listens to.
  void send_changes();

  /// NavigationInfo that was made for programs in a world without one. The scene and the node may have been removed.
  [[nodiscard]] const NodePlace& made_navigation() const { return made_navigation_; }
  void set_made_navigation(const NodePlace& node) { made_navigation_ = node; }

  /// Returns the set of BrowserInputKind that nodes receive.
  [[nodiscard]] std::int32_t event_mask() const { return event_mask_.value_or(0); }
  void set_event_mask(std::int32_t mask) { event_mask_ = mask; }
  /// Reports whether a node receives inputs of this kind.
  [[nodiscard]] bool wants(BrowserInputKind kind) const;
  /// Sends an input of the user to the nodes that listen, as one cascade. Returns true if one of them has set
  /// returnValue to FALSE.
  bool send_input(const BrowserInput& input);
  /// Reports whether the user holds a key. `key` is a key code of Windows.
  [[nodiscard]] bool is_pressed(int key) const { return key > 0 && key < kKeys && pressed_[key]; }
  void release_keys() { pressed_.reset(); }
  /// Reports whether the next step has work: a request that nobody has taken, or effects of an input.
  [[nodiscard]] bool waits() const { return input_sent_ || wanted_position_ || wanted_orientation_ || wanted_mode_; }

 private:
  static constexpr int kKeys = 256;

  [[nodiscard]] NodeId event_node_in(SceneGraph& scene);
  [[nodiscard]] NodeId kept_node(std::unordered_map<std::uint64_t, NodeId>& nodes, SceneGraph& scene,
                                 const NodeType& type);

  Execution& execution_;
  double start_time_ = 0;
  BrowserView view_;
  BrowserSettings settings_;
  std::optional<glm::dvec3> wanted_position_;
  std::optional<glm::dquat> wanted_orientation_;
  std::optional<std::string> wanted_mode_;
  RayCaster caster_;
  NodePlace made_navigation_;
  std::vector<EventNode> nodes_;
  std::unordered_map<std::uint64_t, NodeId> scene_nodes_, event_nodes_;  // made nodes, by SceneGraph::serial
  std::optional<std::int32_t> event_mask_;                               // nullopt until a program sets it
  std::bitset<kKeys> pressed_;
  bool input_sent_ = false;  // an input was sent after the last step
};

}  // namespace gs::vrml
