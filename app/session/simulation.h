#pragma once

#include "app/session/input_rows.h"
#include "app/session/living_world.h"
#include "app/view/picking.h"
#include "app/world/opened_world.h"
#include "render/scene/render_scene.h"
#include "vrml/events/execution.h"
#include "vrml/events/node_names.h"

#include <glm/vec2.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

class WorldLoading;

/// The simulated clock begins at 2000-01-01T00:00:00Z, and goes on in steps of at most this, in seconds.
inline constexpr double kSimulatedStart = 946684800;
inline constexpr double kSimulationStep = 1.0 / 60;

/// A world that lives in simulated time, which depends on nothing else: the same input gives the same events, bit for
/// bit. `trace` and `--snapshot` are callers. One thread; the world must outlive it.
class Simulation {
 public:
  /// `size`: of the picture that the pointing device points at, in pixels.
  Simulation(OpenedWorld& world, const glm::ivec2& size);

  /// Takes in what somebody does. False where rows name what the world does not have; `diagnostics` say which.
  [[nodiscard]] bool plan(const std::vector<InputRow>& rows, const std::string& file, vrml::Diagnostics& diagnostics);
  /// Binds the Viewpoint of this name (see find_viewpoint) at the start, in the place of the first one. What is wrong,
  /// if anything.
  [[nodiscard]] std::optional<std::string> begin_at(const std::string& viewpoint);
  /// Lets `seconds` go by, and does all that is planned for them. Ends early where `go_on` says so. Call once.
  void run(double seconds, const std::function<bool()>& go_on = {});

  /// Urls that are set from now on are read by this, which has read the world, before time goes on.
  void fetch_with(WorldLoading& loading) { loading_ = &loading; }

  [[nodiscard]] vrml::Execution& execution() { return living_.execution(); }
  /// The world as it is now, seen as a picture of it is: from the bound Viewpoint, else so that all is in view.
  const render::RenderList& look();
  /// The same from somewhere else.
  const render::RenderList& look_from(const glm::vec3& viewer);
  /// Of `look`.
  [[nodiscard]] const render::Camera& camera() const { return *camera_; }

 private:
  struct Action {
    double time = 0;
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event = nullptr;
    vrml::FieldValue value;
    std::optional<InputRow> pointer;  // what the pointing device does, instead of an event
  };
  std::optional<std::string> bind_action(const std::string& viewpoint, Action& action);
  std::optional<std::string> set_action(const InputRow& row, Action& action, vrml::SourceLocation& place);
  void act(double time);
  void fetch();
  void point(const InputRow& row);

  OpenedWorld& world_;
  glm::dvec2 size_;
  render::MeshCache meshes_;
  LivingWorld living_;
  std::unique_ptr<vrml::NodeNames> names_;
  std::vector<render::ViewpointState> viewpoints_;
  std::vector<Action> actions_;  // in the order of time
  std::size_t next_action_ = 0;
  std::shared_ptr<LivingScene> seen_;  // null: nobody has looked yet
  std::optional<render::Camera> camera_;
  Pose pose_;
  Picker picker_;
  WorldLoading* loading_ = nullptr;
  bool down_ = false;
};

/// Reads a value of a field type as the text of a file has it (VRML97 clause 5); nodes by what traces call them. Null
/// where the text is no such value.
[[nodiscard]] std::optional<vrml::FieldValue> read_value(const std::string& text, vrml::FieldType type,
                                                         vrml::NodeNames& names);

}  // namespace gs::app
