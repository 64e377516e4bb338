#pragma once

#include "app/script/world/request_queue.h"
#include "app/script/world/script_messages.h"
#include "base/noncopyable.h"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace gs::app::script {

/// Starter of programs, as ProgramLoader needs it.
class ProgramStarter : NonCopyable {
 public:
  virtual ~ProgramStarter() = default;
  /// Runs a text and calls initialize(). Returns false if the text cannot be compiled. `place` is the position of the
  /// text in its file, for messages.
  virtual bool start_text(ScriptRecord& script, std::string_view text, const std::string& file,
                          SourceLocation place) = 0;
};

/// Loader of programs from the url fields of Scripts (VRML97 4.12.1). One thread.
class ProgramLoader : NonCopyable {
 public:
  /// All arguments must outlive the object.
  ProgramLoader(ProgramStarter& starter, ScriptMessages& messages, RequestQueue& requests)
      : starter_(starter), messages_(messages), requests_(requests) {}

  /// Stores the received text of a program until start(). nullopt means that no program could be loaded.
  void provide(vrml::EventNode script, std::optional<std::string> text, const std::string& url);
  void forget(vrml::EventNode script) { texts_.erase(script); }
  /// Tries the remaining entries of the Script's url field. Returns true if a program began.
  bool start(ScriptRecord& script);

 private:
  bool start_received_text(ScriptRecord& script);
  /// Requests all files up to the next inline program; the caller takes the first one that can be read.
  [[nodiscard]] static ScriptRequest next_files(ScriptRecord& script, const vrml::MFString& urls);

  struct Text {
    std::optional<std::string> text;
    std::string url;
  };

  ProgramStarter& starter_;
  ScriptMessages& messages_;
  RequestQueue& requests_;
  std::unordered_map<vrml::EventNode, Text> texts_;  // received texts of programs that have not begun
};

}  // namespace gs::app::script
