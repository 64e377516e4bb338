#pragma once

#include "app/session/documents/session_log.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Line of console output.
struct ProgramLine {
  enum class Kind : std::uint8_t {
    printed,  // output of print() and similar functions
    problem,  // program error
    entered,  // input of the user
    result,   // result of the input
    failure,  // error in the input
  };
  Kind kind = Kind::printed;
  std::string place;  // file:line:column of a problem
  std::string text;
};

/// Contents of the script console: program output from the log, the user's input with results, and the input history.
/// No drawing.
class ScriptConsole {
 public:
  static constexpr std::size_t kMaxLines = 2000, kMaxEntered = 200;

  /// Reads new entries from the log of a world's file. Another world's entries replace the present ones. Returns true
  /// if the lines changed.
  bool take(const SessionLog& log, const std::string& path);
  /// Shows an input line, adds it to the history, and queues it to run. Returns false if it is empty.
  bool enter(const std::string& line);
  /// Returns the input lines that wait to run.
  [[nodiscard]] std::vector<std::string> take_entered() { return std::exchange(waiting_, {}); }
  [[nodiscard]] bool has_entered() const { return !waiting_.empty(); }
  void answer(const std::string& text, bool failed);
  void clear() { lines_.clear(); }
  /// Returns the lines, oldest first; old lines are dropped after kMaxLines.
  [[nodiscard]] const std::vector<ProgramLine>& lines() const { return lines_; }
  /// Returns the previous (`before`) or next history entry; nullopt if there is none. `present` is the line being
  /// edited; it is restored after the newest entry.
  std::optional<std::string> recall(bool before, const std::string& present);

 private:
  void add(ProgramLine line);
  std::vector<ProgramLine> lines_;
  std::vector<std::string> entered_;  // history
  std::vector<std::string> waiting_;  // not run yet
  std::size_t recalled_ = 0;          // index in entered_; its size means the edited line
  std::string edited_;
  std::string path_;
  std::size_t taken_ = 0;  // number of diagnostics read from the log
};

}  // namespace gs::app
