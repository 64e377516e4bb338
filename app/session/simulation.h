#pragma once

#include "app/session/input_rows.h"
#include "app/world/opened_world.h"
#include "vrml/events/execution.h"
#include "vrml/events/node_names.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// The simulated clock begins at 2000-01-01T00:00:00Z, and goes on in steps of at most this, in seconds.
inline constexpr double kSimulatedStart = 946684800;
inline constexpr double kSimulationStep = 1.0 / 60;

/// A world that lives in simulated time, which depends on nothing else: the same input gives the same events, bit for
/// bit. `trace` and `--snapshot` are callers. One thread; the world must outlive it.
class Simulation {
 public:
  /// `meshes`: where what is made to find Viewpoints is kept for others; null: nowhere.
  explicit Simulation(OpenedWorld& world, render::MeshCache* meshes = nullptr);

  /// Takes in what somebody does. False where rows name what the world does not have; `diagnostics` say which.
  [[nodiscard]] bool plan(const std::vector<InputRow>& rows, const std::string& file, vrml::Diagnostics& diagnostics);
  /// Binds the Viewpoint of this name (see find_viewpoint) at the start, in the place of the first one. What is wrong,
  /// if anything.
  [[nodiscard]] std::optional<std::string> begin_at(const std::string& viewpoint);
  /// Lets `seconds` go by, and does all that is planned for them. Ends early where `go_on` says so. Call once.
  void run(double seconds, const std::function<bool()>& go_on = {});

  [[nodiscard]] vrml::Execution& execution() { return execution_; }
  /// Which bindable nodes a picture is to be made with.
  [[nodiscard]] render::BoundNodes bound() const;

 private:
  struct Action {
    double time = 0;
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
    const vrml::InterfaceDeclaration* event = nullptr;
    vrml::FieldValue value;
  };
  std::optional<std::string> bind_action(const std::string& viewpoint, Action& action);
  std::optional<std::string> set_action(const InputRow& row, Action& action, vrml::SourceLocation& place);
  void act(double time);

  OpenedWorld& world_;
  render::MeshCache* meshes_;
  vrml::Execution execution_;
  std::unique_ptr<vrml::NodeNames> names_;
  std::vector<render::ViewpointState> viewpoints_;
  std::vector<Action> actions_;  // in the order of time
  std::size_t next_action_ = 0;
};

/// Reads a value of a field type as the text of a file has it (VRML97 clause 5); nodes by what traces call them. Null
/// where the text is no such value.
[[nodiscard]] std::optional<vrml::FieldValue> read_value(const std::string& text, vrml::FieldType type,
                                                         vrml::NodeNames& names);

}  // namespace gs::app
