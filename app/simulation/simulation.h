#pragma once

#include "app/session/session.h"
#include "app/simulation/input_rows.h"
#include "app/simulation/sensor_tour.h"
#include "vrml/events/execution.h"
#include "vrml/events/node_names.h"

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

class WorldLoading;

/// The simulated clock begins at 2000-01-01T00:00:00Z, and goes on in steps of at most this, in seconds.
inline constexpr double kSimulatedStart = 946684800;
inline constexpr double kSimulationStep = 1.0 / 60;

/// A session of one world in simulated time, which depends on nothing else: the same input gives the same events, bit
/// for bit. `trace` and `--snapshot` are callers. One thread.
class Simulation {
 public:
  /// `size`: of the picture that the pointing device points at, in pixels. The world has a scene.
  Simulation(OpenedWorld world, const glm::ivec2& size, const ViewStyle& style = {});

  /// Takes in what somebody does. False where rows name what the world does not have; `diagnostics` say which.
  [[nodiscard]] bool plan(const std::vector<InputRow>& rows, const std::string& file, vrml::Diagnostics& diagnostics);
  /// Binds the Viewpoint of this name (see find_viewpoint) at the start, in the place of the first one. What is wrong,
  /// if anything.
  [[nodiscard]] std::optional<std::string> begin_at(const std::string& viewpoint);
  /// Somebody tries all sensors while time goes by.
  void press_sensors() { tour_.emplace(session_); }
  /// What has become of that.
  [[nodiscard]] SensorTour::Counts pressed_sensors() { return tour_ ? tour_->counts() : SensorTour::Counts{}; }
  /// What of the plan could not be done when its time came.
  [[nodiscard]] const vrml::Diagnostics& troubles() const { return troubles_; }
  /// Lets time go on until `seconds` after the start, and does all that is planned until then. Ends early where `go_on`
  /// says so. The times of several calls grow.
  void run(double seconds, const std::function<bool()>& go_on = {});

  /// Urls that are set from now on are read by this, which has read the world, before time goes on.
  void fetch_with(WorldLoading& loading) { loading_ = &loading; }

  /// What is heard goes to `sink`, pairs left and right of kMixRate a second, in pieces, from now on: each step's is
  /// mixed as the step has left the world.
  void hear(std::function<void(std::span<const float>)> sink) { sink_ = std::move(sink); }

  /// Who measures what time goes to, which must outlive it.
  void measure(render::PhaseClock* phases) { document_->meshes.phases = phases; }

  [[nodiscard]] OpenedWorld& world() { return document_->world; }
  [[nodiscard]] vrml::Execution& execution() { return document_->living->execution(); }
  /// Of its Scripts; see LivingWorld::observe_scripts.
  void observe_scripts(std::function<void(const ScriptMessage&)> observer) {
    document_->living->observe_scripts(std::move(observer));
  }
  /// The world as it is after `run`, and who looks at it.
  [[nodiscard]] const View& look();
  /// What a picture of it is drawn with: of `look`.
  [[nodiscard]] render::Camera camera();
  /// The viewer is where a picture is taken from: sensors that he meets there, and what is fixed to him, follow at
  /// once. Where he is there already, nothing happens.
  void stand_at(const render::Camera& camera);
  /// The same world from somewhere else.
  const render::RenderList& look_from(const glm::dvec3& viewer, const glm::dvec3& up = {0, 1, 0});

 private:
  /// What happens at a time: an event for a node, a Viewpoint that is chosen, what is done with a sensor or the viewer,
  /// or an event of the window.
  struct Action {
    double time = 0;
    InputRow::Kind kind = InputRow::Kind::move;
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event = nullptr;  // of Kind::set
    vrml::FieldValue value;
    glm::dvec2 pointer{0};
    glm::dvec3 place{0};
    WindowEvent input;
    vrml::Diagnostic trouble;  // if it cannot be done
  };
  std::optional<std::string> bind_action(const std::string& viewpoint, Action& action);
  std::optional<std::string> sensor_action(const InputRow& row, Action& action);
  std::optional<std::string> set_action(const InputRow& row, Action& action, vrml::SourceLocation& place);
  void input_action(const InputRow& row, Action& action);
  void step(double time, bool look);
  void choose_viewpoint(const vrml::SceneGraph& scene, vrml::NodeId node);
  void act(double time);
  void fetch();
  void listen(double time);

  std::shared_ptr<Document> document_;
  SessionInput input_;  // of the steps
  Session session_;
  std::optional<SensorTour> tour_;
  vrml::Diagnostics troubles_;
  std::unique_ptr<vrml::NodeNames> names_;  // null: no row has named a node
  std::vector<render::ViewpointState> viewpoints_;
  std::vector<Action> actions_;  // in the order of time
  std::size_t next_action_ = 0;
  bool begins_elsewhere_ = false;  // at a Viewpoint that is not the first one
  double time_ = 0;
  std::uint64_t steps_ = 0;  // 1 / kSimulationStep of a second, of which the next one ends; 0: time has not begun
  // As the rows have left them.
  glm::vec2 pointer_{0};
  bool shift_ = false, control_ = false;
  WorldLoading* loading_ = nullptr;
  std::function<void(std::span<const float>)> sink_;
  std::int64_t heard_ = 0;  // pairs
};

}  // namespace gs::app
