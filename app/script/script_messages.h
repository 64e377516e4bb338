#pragma once

#include "app/script/program.h"
#include "app/script/script_runner.h"

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
  /// Reports a problem of a program, at the position `at` or at its Script.
  void report(Severity severity, const Program& program, std::string message, std::optional<Diagnostic> at = {});
  /// Reports the first write of a program to another node, if its Script has directOutput FALSE.
  void report_direct_output(Program& program);

 private:
  void tell(ScriptMessage message);

  std::vector<ScriptMessage> messages_;
  std::function<void(const ScriptMessage&)> observer_;
  std::unordered_set<std::string> said_;
};

/// Reporter of the failures of programs. Switches a program off after its third fault. One thread.
class ProgramFaults {
 public:
  static constexpr int kMax = 3;
  static constexpr char kLate[] = "the program exceeded the time limit";

  /// All arguments must outlive the object.
  ProgramFaults(Engine& engine, const vrml::Execution& execution, ScriptMessages& messages)
      : engine_(engine), execution_(execution), messages_(messages) {}

  /// Reports that a turn of a program failed, and clears the pending exception.
  void report(Program& program, const Engine::Turn& turn);

 private:
  void report_exception(Program& program);
  void add(Program& program, const std::string& why, std::optional<Diagnostic> at = {});

  Engine& engine_;
  const vrml::Execution& execution_;
  ScriptMessages& messages_;
};

/// Returns the message for a program that exceeds its time by far; see Engine::on_overdue().
[[nodiscard]] std::string late_message_of(const Program& program);

}  // namespace gs::app::script
