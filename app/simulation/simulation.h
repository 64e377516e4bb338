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

/// Start of simulated time, 2000-01-01T00:00:00Z, in seconds since 1970. Time advances in steps of at most
/// kSimulationStep seconds.
inline constexpr double kSimulatedStart = 946684800;
inline constexpr double kSimulationStep = 1.0 / 60;

/// Session of one world in simulated time. Equal input gives equal events, bit for bit. The command `trace` and the
/// option `--snapshot` use it. One thread.
class Simulation {
 public:
  /// Starts the simulation of a world, which must have a scene. `size` is the picture size in pixels, which the
  /// pointing device needs.
  Simulation(LoadedWorld world, const glm::ivec2& size, const ViewStyle& style = {});

  /// Plans the actions of input rows. Returns false if a row names a node or event that the world lacks; `diagnostics`
  /// then has the errors.
  [[nodiscard]] bool plan(const std::vector<InputRow>& rows, const std::string& file, Diagnostics& diagnostics);
  /// Binds the Viewpoint of this name at the start, instead of the first one (see find_viewpoint()). Returns the error,
  /// or nullopt.
  [[nodiscard]] std::optional<std::string> begin_at(const std::string& viewpoint);
  /// Tries all sensors while time passes; see SensorTour.
  void press_sensors() { tour_.emplace(session_); }
  /// Returns the counts of press_sensors(); all are 0 without it.
  [[nodiscard]] SensorTour::Counts pressed_sensors() { return tour_ ? tour_->counts() : SensorTour::Counts{}; }
  /// Returns errors of planned actions that failed at their time.
  [[nodiscard]] const Diagnostics& troubles() const { return troubles_; }
  /// Advances time to `seconds` after the start and runs the actions that are planned until then. Stops early if
  /// `go_on` returns false. A later call needs a greater time.
  void run(double seconds, const std::function<bool()>& go_on = {});

  /// Takes results of loading into the world.
  void arrive(ResourceUpdates updates);
  /// Lets `loading` read the urls that the world sets from now on. Each step waits for their contents before time
  /// advances.
  void fetch_with(WorldLoading& loading) { loading_ = &loading; }

  /// Sends the sound to `sink` in blocks of stereo pairs at kMixRate. The block of a step is mixed from the state after
  /// that step.
  void hear(std::function<void(std::span<const float>)> sink) { sink_ = std::move(sink); }

  /// Records the durations of phases in `phases`, which must outlive the simulation.
  void measure(PhaseClock* phases) { document_->meshes.phases = phases; }

  [[nodiscard]] LoadedWorld& world() { return document_->world; }
  [[nodiscard]] vrml::Execution& execution() { return document_->runtime->execution(); }
  /// Sets the receiver of messages from Scripts; see WorldPrograms::observe().
  void observe_scripts(std::function<void(const ScriptMessage&)> observer) {
    document_->runtime->programs().observe(std::move(observer));
  }
  /// Returns the view of the world at the time that run() reached.
  [[nodiscard]] const View& look();
  /// Returns the camera of the view that look() returns.
  [[nodiscard]] render::Camera camera();
  /// Moves the viewer to the camera of a picture. Updates sensors and objects that follow the viewer, at the present
  /// time. Does nothing if the viewer is already there.
  void stand_at(const render::Camera& camera);
  /// Returns the render list as a camera sees it.
  const render::RenderList& look_from(const render::Camera& camera);

 private:
  /// Planned action: an event for a node, a new Viewpoint, an action on a sensor or the viewer, or a window event.
  struct Action {
    double time = 0;
    InputRow::Kind kind = InputRow::Kind::move;
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event = nullptr;  // only for Kind::set
    vrml::FieldValue value;
    glm::dvec2 pointer{0};
    glm::dvec3 place{0};
    WindowEvent input;
    Diagnostic trouble;  // error to report if the action fails
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
  SessionInput input_;  // input of the following steps
  Session session_;
  std::optional<SensorTour> tour_;
  Diagnostics troubles_;
  std::unique_ptr<vrml::NodeNames> names_;  // null until an input row names a node
  std::vector<render::ViewpointState> viewpoints_;
  std::vector<Action> actions_;  // ordered by time
  std::size_t next_action_ = 0;
  bool begins_elsewhere_ = false;  // begin_at() chose a Viewpoint
  double time_ = 0;
  std::uint64_t steps_ = 0;  // number of the current step, from 1; 0 before the start
  // State of pointer and modifier keys after the last planned row.
  glm::vec2 pointer_{0};
  bool shift_ = false, control_ = false;
  WorldLoading* loading_ = nullptr;
  std::function<void(std::span<const float>)> sink_;
  std::int64_t heard_ = 0;  // number of stereo pairs sent to `sink_`
};

}  // namespace gs::app
