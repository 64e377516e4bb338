#pragma once

#include "app/script/script_runner.h"
#include "app/script/world/script_record.h"

#include <functional>
#include <optional>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gs::app::script {

/// Messages of the programs of a world. Reports each problem once. One thread.
class ScriptMessages {
 public:
  /// Sets a function that receives each message at once; take() then returns none.
  void observe(std::function<void(const ScriptMessage&)> observer) { observer_ = std::move(observer); }
  [[nodiscard]] std::vector<ScriptMessage> take() { return std::exchange(messages_, {}); }

  /// Adds a line that a program printed.
  void print(std::string text);
  void report(Diagnostic problem);
  /// Reports a problem of a program at the position `at`. If `at` lacks the file or the position, uses the Script's.
  void report(Severity severity, const ScriptRecord& script, std::string message, std::optional<Diagnostic> at = {});
  /// Reports the first write of a program to another node, if its Script has directOutput FALSE.
  void report_direct_output(ScriptRecord& script);

 private:
  void tell(ScriptMessage message);

  std::vector<ScriptMessage> messages_;
  std::function<void(const ScriptMessage&)> observer_;
  std::unordered_set<std::string> said_;
};

/// Returns the message for a program that exceeds its time by far; see Engine::on_overdue().
[[nodiscard]] std::string late_message_of(const ScriptRecord& script);

}  // namespace gs::app::script
