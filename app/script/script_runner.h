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

/// Printed text of a program, or its error.
struct ScriptMessage {
  Diagnostic diagnostic;
  bool printed = false;  // `diagnostic.message` is a line of print() or trace()
};

/// Request of a program to the browser that only a session can fulfil (VRML97 4.12.10).
struct ScriptRequest {
  enum class Kind : std::uint8_t {
    program,          // the text of the Script's url, see ScriptRunner::found
    load_url,         // an Anchor would do the same
    create_from_url,  // nodes of a file, to be sent to an eventIn
    description,      // `text` is to be shown
    viewpoint,        // `text`: the Viewpoint of this description or name is to be bound
  };
  Kind kind = Kind::load_url;
  std::vector<std::string> urls, parameters;
  std::string text;
  const vrml::SourceText* origin = nullptr;        // SourceText::origin of the Script's text
  std::shared_ptr<const vrml::TextSource> source;  // of the Script's text
  const vrml::SceneGraph* from_scene = nullptr;    // the scene of the Script
  vrml::SceneGraph* scene = nullptr;               // of the Script, or of the node that gets the event
  vrml::NodeId node;
  const vrml::InterfaceDeclaration* event_in = nullptr;
  SourceLocation location;   // of the Script
  bool from_client = false;  // a client of --control asks; its files are held to the world's folder
};

/// Properties of the browser that programs can read.
struct BrowserState {
  std::string world_url;
  double speed = 0, frame_rate = 0;  // metres and pictures a second
};

/// Runs ECMAScript programs (VRML97 Annex C) for an Execution, with SpiderMonkey. What a program may take of time and
/// memory, Limits say; it reaches nothing but the nodes of its world and what is asked for by `take_requests`. One
/// thread, that of the Execution, which must outlive it.
class ScriptRunner : public vrml::ScriptHost {
 public:
  struct Settings {
    /// Seconds for all programs of a step together; what is left waits for the next one. 0: no matter how long.
    double step_seconds = 0;
    /// Math.random gives the same numbers each time, and Date tells the world's time.
    bool repeatable = false;
  };

  /// Returns null if there is too little memory for an engine.
  [[nodiscard]] static std::unique_ptr<ScriptRunner> make(vrml::Execution& execution, Settings settings);

  /// Sets the function that gets a message for the user when a program has exceeded its time by over 2 s. That happens
  /// inside single calls of the engine that nothing can interrupt. Another thread calls it repeatedly until the program
  /// ends. Any thread.
  static void on_overdue(std::function<void(const std::string&)> observer);

  /// A step begins.
  virtual void begin_step() = 0;
  virtual void set_browser(BrowserState state) = 0;
  /// Delivers the program that a Script requested, or nullopt if no requested program can be loaded.
  virtual void found(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                     const std::string& url) = 0;
  /// The same in front of the Script itself: it does not ask.
  virtual void provide(const vrml::SceneGraph& scene, vrml::NodeId script, std::optional<std::string> text,
                       const std::string& url) = 0;
  /// Result of a line: the text of its value, or its error.
  struct Evaluation {
    std::string text;
    bool failed = false;
  };
  /// Runs a line in the name of a Script, with all that its program knows and within the limits of all programs, which
  /// do not count it as a fault. What it assigns goes on with Execution::end_update; to be called behind begin_update.
  [[nodiscard]] virtual Evaluation evaluate(const vrml::SceneGraph& scene, vrml::NodeId script,
                                            const std::string& line) = 0;
  [[nodiscard]] virtual std::vector<ScriptMessage> take_messages() = 0;
  /// Is given each message at once, in place of take_messages.
  virtual void observe(std::function<void(const ScriptMessage&)> observer) = 0;
  [[nodiscard]] virtual std::vector<ScriptRequest> take_requests() = 0;
  /// Drops the requests that name a scene, or come from one, which is about to be removed.
  virtual void forget_scene(const vrml::SceneGraph& scene) = 0;
  /// URL of the first private text that a Script of this world has read (script/read_rule.h); empty if there is none.
  [[nodiscard]] virtual const std::string& private_file() const = 0;
  /// Whether the last step had no time left for all programs.
  [[nodiscard]] virtual bool is_late() const = 0;
};

/// Program in a Script's url list, and its position: `javascript:`, `vrmlscript:` and `ecmascript:` contain it (VRML97
/// 4.5.5, C.3.1).
struct ProgramPlace {
  enum class Kind : std::uint8_t { held, file, java, unknown };
  Kind kind = Kind::unknown;
  std::string_view text;  // of `held`; the language of one that is `unknown`
};
[[nodiscard]] ProgramPlace program_place(std::string_view url);

/// Reports errors in the programs of the scene's Scripts, without running them.
void check_programs(const vrml::SceneGraph& scene, Diagnostics& diagnostics);

}  // namespace gs::app
