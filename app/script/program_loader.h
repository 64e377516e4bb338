#pragma once

#include "app/script/program_calls.h"
#include "app/script/request_queue.h"
#include "app/script/script_library.h"

#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

namespace gs::app::script {

/// Loader of programs from the url fields of Scripts (VRML97 4.12.1). One thread.
class ProgramLoader {
 public:
  /// All arguments must outlive the object.
  ProgramLoader(vrml::Execution& execution, Engine& engine, ScriptLibraries& libraries, ProgramCalls& calls,
                ScriptMessages& messages, RequestQueue& requests)
      : execution_(execution),
        engine_(engine),
        libraries_(libraries),
        calls_(calls),
        messages_(messages),
        requests_(requests) {}

  /// Stores the received text of a program until start(). nullopt means that no program could be loaded.
  void provide(vrml::EventNode script, std::optional<std::string> text, const std::string& url);
  void forget(vrml::EventNode script) { texts_.erase(script); }
  /// Tries the remaining entries of the Script's url field. Returns true if a program began.
  bool start(Program& program);

 private:
  /// Runs a text and calls initialize(). Returns false if the text cannot be compiled.
  bool start_text(Program& program, std::string_view text, const std::string& file, SourceLocation place);
  bool start_received_text(Program& program);
  /// Requests all files up to the next inline program; the caller takes the first one that can be read.
  [[nodiscard]] ScriptRequest next_files(Program& program, const vrml::MFString& urls) const;
  /// Compiles and runs the text of a program. `place` is the position of the text in its file, for messages.
  bool load(Program& program, std::string_view text, const std::string& file, SourceLocation place);

  struct Text {
    std::optional<std::string> text;
    std::string url;
  };

  vrml::Execution& execution_;
  Engine& engine_;
  ScriptLibraries& libraries_;
  ProgramCalls& calls_;
  ScriptMessages& messages_;
  RequestQueue& requests_;
  std::unordered_map<vrml::EventNode, Text> texts_;  // received texts of programs that have not begun
};

}  // namespace gs::app::script
