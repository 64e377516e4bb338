#pragma once

#include "app/session/session.h"
#include "app/simulation/input_rows.h"
#include "app/simulation/sensor_tour.h"
#include "vrml/events/execution.h"
#include "vrml/scene/node_names.h"

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

/// Simulated time starts at 2000-01-01T00:00:00Z and advances in steps of at most kSimulationStep seconds.
inline constexpr double kSimulatedStart = 946684800;
inline constexpr double kSimulationStep = 1.0 / 60;

/// Session of one world in simulated time. The same input gives the same events, bit for bit. `trace` and `--snapshot`
/// use it. One thread.
class Simulation {
 public:
  /// Starts a simulation of a world, which must have a scene. `size` is the picture for the pointing device, in pixels.
  Simulation(LoadedWorld world, const glm::ivec2& size, const ViewStyle& style = {});

  /// Plans input rows. Returns false if rows name things that the world lacks; `diagnostics` lists them.
  [[nodiscard]] bool plan(const std::vector<InputRow>& rows, const std::string& file, Diagnostics& diagnostics);
  /// Starts at the Viewpoint of this name (see find_viewpoint()) instead of the first one. Returns the problem, or
  /// nullopt.
  [[nodiscard]] std::optional<std::string> begin_at(const std::string& viewpoint);
  /// Presses all sensors while time passes.
  void press_sensors() { tour_.emplace(session_); }
  /// Returns the results of press_sensors().
  [[nodiscard]] SensorTour::Counts pressed_sensors() { return tour_ ? tour_->counts() : SensorTour::Counts{}; }
  /// Returns the planned actions that failed when they were due.
  [[nodiscard]] const Diagnostics& troubles() const { return troubles_; }
  /// Advances time to `seconds` after the start and runs the actions planned until then. Stops early if `go_on` returns
  /// false. Later calls need later times.
  void run(double seconds, const std::function<bool()>& go_on = {});

  /// Reads urls that are set from now on with the loader of the world, before time advances.
  void fetch_with(WorldLoading& loading) { loading_ = &loading; }

  /// Sends the sound to `sink` in pieces, as left and right pairs at kMixRate. Each step is mixed from the state after
  /// it.
  void hear(std::function<void(std::span<const float>)> sink) { sink_ = std::move(sink); }

  /// Measures the time of phases with `phases`, which must outlive the simulation.
  void measure(PhaseClock* phases) { document_->meshes.phases = phases; }

  [[nodiscard]] LoadedWorld& world() { return document_->world; }
  [[nodiscard]] vrml::Execution& execution() { return document_->runtime->execution(); }
  /// Sets the receiver of script messages; see WorldPrograms::observe().
  void observe_scripts(std::function<void(const ScriptMessage&)> observer) {
    document_->runtime->programs().observe(std::move(observer));
  }
  /// Returns the view of the world after `run`.
  [[nodiscard]] const View& look();
  /// Returns the camera for a picture of the view that look() returns.
  [[nodiscard]] render::Camera camera();
  /// Moves the viewer to the camera of a picture. Sensors there, and objects that follow the viewer, are updated at
  /// once. Does nothing if the viewer is there already.
  void stand_at(const render::Camera& camera);
  /// Returns the render list of the world for another viewer position.
  const render::RenderList& look_from(const glm::dvec3& viewer, const glm::dvec3& up = {0, 1, 0});

 private:
  /// Planned action: an event for a node, a Viewpoint change, an action on a sensor or the viewer, or a window event.
  struct Action {
    double time = 0;
    InputRow::Kind kind = InputRow::Kind::move;
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event = nullptr;  // for Kind::set
    vrml::FieldValue value;
    glm::dvec2 pointer{0};
    glm::dvec3 place{0};
    WindowEvent input;
    Diagnostic trouble;  // reported if the action fails
  };
  std::optional<std::string> bind_action(const std::string& viewpoint, Action& action);
  std::optional<std::string> sensor_action(const InputRow& row, Action& action);
  std::optional<std::string> set_action(const InputRow& row, Action& action, SourceLocation& place);
  void input_action(const InputRow& row, Action& action);
  void step(double time, bool look);
  void choose_viewpoint(const vrml::SceneGraph& scene, vrml::NodeId node);
  void act(double time);
  void fetch();
  void listen(double time);

  std::shared_ptr<Document> document_;
  SessionInput input_;  // input of the next steps
  Session session_;
  std::optional<SensorTour> tour_;
  Diagnostics troubles_;
  std::unique_ptr<vrml::NodeNames> names_;  // null until a row names a node
  std::vector<render::ViewpointState> viewpoints_;
  std::vector<Action> actions_;  // ordered by time
  std::size_t next_action_ = 0;
  bool begins_elsewhere_ = false;  // at a Viewpoint other than the first
  double time_ = 0;
  std::uint64_t steps_ = 0;  // steps of kSimulationStep that ended with the current one; 0 before the start
  // State of the input after the last row.
  glm::vec2 pointer_{0};
  bool shift_ = false, control_ = false;
  WorldLoading* loading_ = nullptr;
  std::function<void(std::span<const float>)> sink_;
  std::int64_t heard_ = 0;  // pairs of samples
};

}  // namespace gs::app
