#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/script/script_runner.h"
#include "vrml/events/execution.h"
#include "vrml/syntax/parser.h"

#include <glm/vec3.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Programs of a running world: its Scripts, their messages, and the browser state that they can query (VRML97
/// 4.12.10). Used by the world's thread.
class WorldPrograms {
 public:
  WorldPrograms(LoadedWorld& world, vrml::Execution& execution);
  WorldPrograms(const WorldPrograms&) = delete;
  WorldPrograms& operator=(const WorldPrograms&) = delete;

  /// Sets how programs run. Call before `start`.
  void set_settings(ScriptRunner::Settings settings) { settings_ = settings; }
  /// Creates the script engine if the world has a Script and there is no engine yet.
  void start();
  /// Destroys the script engine. Call before the rest of the world is destroyed.
  void stop();
  /// Updates speed and frame rate before a step to `now`.
  void begin_step(double now);

  /// Sets the receiver of messages. Without one, take_messages() returns them.
  void observe(std::function<void(const ScriptMessage&)> observer);
  [[nodiscard]] std::vector<ScriptMessage> take_messages();
  /// Adds a message.
  void tell(ScriptMessage message);

  /// Makes nodes from VRML text; see make_nodes(). Scripts among them run from the next event on.
  [[nodiscard]] vrml::RunTimeNodes create(vrml::SceneGraph& scene, const std::string& label, std::string_view text,
                                          Diagnostics& diagnostics, const vrml::SourceText* written_by,
                                          std::shared_ptr<const vrml::TextSource> fetched_from = nullptr);
  /// Runs a line as part of a Script's program, and the events that follow; see ScriptRunner::evaluate(). With a null
  /// node, the line belongs to a console program, which has the browser's interface (VRML97 4.12.10) and the results of
  /// earlier lines. Call after the world has started.
  [[nodiscard]] ScriptRunner::Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                                  const std::string& line);
  /// Returns the browser state as of the last step. Speed and frame rate are set only if the world has Scripts or
  /// `measure_viewer` was called.
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  void measure_viewer() { measures_viewer_ = true; }
  /// Returns the script runner, or null if the world has no Script.
  [[nodiscard]] ScriptRunner* runner() const { return runner_.get(); }

 private:
  LoadedWorld& world_;
  vrml::Execution& execution_;
  ScriptRunner::Settings settings_{0.05, false};
  std::function<void(const ScriptMessage&)> observer_;
  std::vector<ScriptMessage> messages_;  // messages of this class, not of programs
  BrowserState browser_;
  std::optional<glm::dvec3> viewer_;  // position in the last step
  bool measures_viewer_ = false;
  vrml::NodeId console_;  // Script to which the console's lines belong
  std::unique_ptr<ScriptRunner> runner_;
};

}  // namespace gs::app
