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
    printed,  // output of print() and similar functions of a program
    problem,  // error of a program
    entered,  // input of the user
    result,  // result of that input
    failure,  // error in that input
  };
  Kind kind = Kind::printed;
  std::string place;  // file:line:column of an error
  std::string text;
};

/// Content of the script console: program output from the log, the user's input with results, and the input history.
/// Draws nothing.
class ScriptConsole {
 public:
  static constexpr std::size_t kMaxLines = 2000, kMaxEntered = 200;

  /// Reads new entries about the world in file `path` from the log. If the world is another one, first removes all
  /// lines. Returns true if the lines changed.
  bool take(const SessionLog& log, const std::string& path);
  /// Adds an input line to the console, to the history, and to the queue of lines to run. Returns false if the line is
  /// empty.
  bool enter(const std::string& line);
  /// Returns the input lines that have not run yet, and empties their queue.
  [[nodiscard]] std::vector<std::string> take_entered() { return std::exchange(waiting_, {}); }
  [[nodiscard]] bool has_entered() const { return !waiting_.empty(); }
  void answer(const std::string& text, bool failed);
  void clear() { lines_.clear(); }
  /// Returns the lines, oldest first. Only the last kMaxLines exist.
  [[nodiscard]] const std::vector<ProgramLine>& lines() const { return lines_; }
  /// Returns the previous history entry if `before` is true, else the next one, or nullopt if there is none. `present`
  /// is the line that the user is editing. It comes back after the newest entry.
  std::optional<std::string> recall(bool before, const std::string& present);

 private:
  void add(ProgramLine line);
  std::vector<ProgramLine> lines_;
  std::vector<std::string> entered_;  // history of input lines
  std::vector<std::string> waiting_;  // input lines that have not run yet
  std::size_t recalled_ = 0;  // index in entered_; entered_.size() means the edited line
  std::string edited_;
  std::string path_;
  std::size_t taken_ = 0;  // number of diagnostics that were read from the log
};

}  // namespace gs::app
