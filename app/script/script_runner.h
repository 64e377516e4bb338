#pragma once

#include "base/diagnostic.h"
#include "vrml/event_model/script_host.h"
#include "vrml/events/execution.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Printed line of a program, or its error.
struct ScriptMessage {
  Diagnostic diagnostic;
  bool printed = false;  // true if `diagnostic.message` was printed by print() or trace()
};

/// Request of a Script that only a session can fulfil (VRML97 4.12.10).
struct ScriptRequest {
  enum class Kind : std::uint8_t {
    program,          // fetch the program in the Script's url field, see ScriptRunner::found()
    load_url,         // open a URL, as an Anchor would
    create_from_url,  // read the nodes of a file and send them to an eventIn
    description,      // show `text` to the user
    viewpoint,        // bind the Viewpoint with the description or name `text`
  };
  Kind kind = Kind::load_url;
  std::vector<std::string> urls, parameters;
  std::string text;
  const vrml::SourceText* origin = nullptr;        // SourceText::origin() of the text that contains the Script
  std::shared_ptr<const vrml::TextSource> source;  // source of that text
  const vrml::SceneGraph* from_scene = nullptr;    // scene of the Script
  vrml::SceneGraph* scene = nullptr;               // scene of `node`
  vrml::NodeId node;
  const vrml::InterfaceDeclaration* event_in = nullptr;
  SourceLocation location;   // of the Script in its file
  bool from_client = false;  // requested by a client of --control, which may read files only in the world's folder
};

/// Properties of the browser that Scripts can read.
struct BrowserState {
  std::string world_url;
  double speed = 0;         // metres/s
  double frame_rate = 100;  // pictures/s; 100 until it is measured (VRML97 4.12.10.3)
};

/// Runner of ECMAScript programs (VRML97 Annex C) for an Execution, with SpiderMonkey. Programs run in a confined child
/// process (script/process/program_process.h). vrml::Limits bounds their time and memory. They reach only the nodes of
/// their world; everything else is a request that take_requests() returns. Use on the thread of the Execution, which
/// must outlive the runner.
class ScriptRunner : public vrml::ScriptHost {
 public:
  struct Settings {
    /// Seconds for all programs of a step together; the remaining events wait for the next step. 0 means unlimited.
    double step_seconds = 0;
    /// Makes results repeatable: Math.random has a fixed sequence, and Date returns the time of the world.
    bool repeatable = false;
  };

  /// Creates a runner. Returns null if there is too little memory for SpiderMonkey.
  [[nodiscard]] static std::unique_ptr<ScriptRunner> make(vrml::Execution& execution, Settings settings);

  /// Sets the function that gets a message for the user when a program has exceeded its time by over 2 s. This happens
  /// inside single calls of SpiderMonkey that cannot be interrupted. Another thread calls the function repeatedly until
  /// the program ends. Any thread.
  static void on_overdue(std::function<void(const std::string&)> observer);

  /// Begins a step of the world, with the full time for programs.
  virtual void begin_step() = 0;
  virtual void set_browser(BrowserState state) = 0;
  /// Delivers the text of a program that a Script requested. nullopt means that no program of its url could be loaded.
  virtual void found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                     const std::string& url) = 0;
  /// Provides the text of a program before the Script begins, so that the Script does not request it. nullopt means
  /// that it could not be loaded.
  virtual void provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                       const std::string& url) = 0;
  /// Text of a line's value, or of its error.
  struct Evaluation {
    std::string text;
    bool failed = false;
  };
  /// Runs a line of code in the name of a Script, with the names of its program and the limits of programs. Errors do
  /// not count as faults of the program. Call after EventCascade::begin_update(); EventCascade::drain() processes the
  /// events that the line sends.
  [[nodiscard]] virtual Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                            const std::string& line) = 0;
  [[nodiscard]] virtual std::vector<ScriptMessage> take_messages() = 0;
  /// Sets a function that receives each message at once; take_messages() then returns none.
  virtual void observe(std::function<void(const ScriptMessage&)> observer) = 0;
  [[nodiscard]] virtual std::vector<ScriptRequest> take_requests() = 0;
  /// Drops requests of or for a scene that is about to be removed.
  virtual void forget_scene(const vrml::SceneGraph& scene) = 0;
  /// Returns the URL of the first confidential file that a Script of this world has read (script/read_rule.h); empty if
  /// there is none.
  [[nodiscard]] virtual const std::string& private_file() const = 0;
  /// Returns why all programs of this world have ended, for example because one of them could not be interrupted; empty
  /// while programs can run.
  [[nodiscard]] virtual const std::string& stopped() const = 0;
  /// Reports whether the time of the last step did not suffice for all programs.
  [[nodiscard]] virtual bool is_late() const = 0;
};

/// Program in one URL of a Script's url field. The schemes `javascript:`, `vrmlscript:` and `ecmascript:` contain the
/// program itself (VRML97 4.5.5, C.3.1).
struct ProgramPlace {
  enum class Kind : std::uint8_t { held, file, java, unknown };
  Kind kind = Kind::unknown;
  std::string_view text;  // the program if `held`, the language if `unknown`
};
[[nodiscard]] ProgramPlace program_place(std::string_view url);

/// Reports errors in the programs that the Scripts of a scene contain. Compiles the programs without running them.
void check_programs(const vrml::SceneGraph& scene, Diagnostics& diagnostics);

}  // namespace gs::app
