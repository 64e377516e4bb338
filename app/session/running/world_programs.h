#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/script/script_runner.h"
#include "base/noncopyable.h"
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

/// Programs of a running world: its Scripts, their messages, and the browser properties that Scripts can read (VRML97
/// 4.12.10). Use on the world's thread.
class WorldPrograms : NonCopyable {
 public:
  WorldPrograms(LoadedWorld& world, vrml::Execution& execution);

  /// Sets the settings of the script runner. Call before start().
  void set_settings(ScriptRunner::Settings settings) { settings_ = settings; }
  /// Creates the script runner if the world has a Script and no runner yet.
  void start();
  /// Destroys the script runner. Call before other parts of the world are destroyed.
  void stop();
  /// Begins a step to time `now`, in seconds since 1970. Updates speed and frame rate.
  void begin_step(double now);

  /// Sets the receiver of messages. Without one, take_messages() returns them.
  void observe(std::function<void(const ScriptMessage&)> observer);
  [[nodiscard]] std::vector<ScriptMessage> take_messages();
  /// Reports a message to the observer; without one, take_messages() returns it.
  void tell(ScriptMessage message);

  /// Makes nodes from VRML text; see make_nodes(). Scripts among the nodes start at the next event.
  [[nodiscard]] vrml::RunTimeNodes create(vrml::SceneGraph& scene, const std::string& label, std::string_view text,
                                          Diagnostics& diagnostics, const vrml::SourceText* written_by,
                                          std::shared_ptr<const vrml::TextSource> fetched_from = nullptr);
  /// Runs a line of code in the program of a Script, and processes the resulting events; see ScriptRunner::evaluate().
  /// If `script` is null, the line runs in a separate console program. This program has the Browser object (VRML97
  /// 4.12.10) and keeps the variables of earlier lines. Call after the world has started.
  [[nodiscard]] ScriptRunner::Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                                  const std::string& line);
  /// Returns the properties of the browser at the last step. Speed and frame rate are measured only if the world has
  /// Scripts or after measure_viewer().
  [[nodiscard]] const BrowserState& browser() const { return browser_; }
  void measure_viewer() { measures_viewer_ = true; }
  /// Returns the script runner; null if the world has no Script.
  [[nodiscard]] ScriptRunner* runner() const { return runner_.get(); }

 private:
  LoadedWorld& world_;
  vrml::Execution& execution_;
  ScriptRunner::Settings settings_{0.05, false};
  std::function<void(const ScriptMessage&)> observer_;
  std::vector<ScriptMessage> messages_;  // messages of this class, not of programs
  BrowserState browser_;
  std::optional<glm::dvec3> viewer_;  // position of the viewer in the last step
  bool measures_viewer_ = false;
  vrml::NodeId console_;  // Script node of the console program
  std::unique_ptr<ScriptRunner> runner_;
};

}  // namespace gs::app
