#pragma once

#include "app/session/documents/session_log.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// What a program said, and where.
struct ProgramLine {
  enum class Kind : std::uint8_t {
    printed,  // by print() and its like
    problem,  // what is wrong with a program
    entered,  // by the user
    result,   // of what he entered
    failure,  // likewise: what is wrong with it
  };
  Kind kind = Kind::printed;
  std::string place;  // file:line:column of a problem
  std::string text;
};

/// The lines of the script console: what the programs of a world say, as the log has it, between what the user enters
/// and its results; and what he has entered before. Plain bookkeeping.
class ScriptConsole {
 public:
  static constexpr std::size_t kMostLines = 2000, kMostEntered = 200;

  /// Takes what is new in the log of a world's file; another world's lines take the place of those that are there.
  /// True: there are other lines than before.
  bool take(const SessionLog& log, const std::string& path);
  /// A line that is to be run: it is shown, and goes among those that were entered. False: there is nothing in it.
  bool enter(const std::string& line);
  void answer(const std::string& text, bool failed);
  void clear() { lines_.clear(); }
  /// The oldest first; of very many, the last ones.
  [[nodiscard]] const std::vector<ProgramLine>& lines() const { return lines_; }
  /// What was entered before the line that is being edited, or behind it again; nothing: there is none. `present`: what
  /// stands there, which comes back behind the last.
  std::optional<std::string> recall(bool before, const std::string& present);

 private:
  void add(ProgramLine line);
  std::vector<ProgramLine> lines_;
  std::vector<std::string> entered_;
  std::size_t recalled_ = 0;  // of entered_; its end: the line that is being edited
  std::string edited_;
  std::string path_;
  std::size_t taken_ = 0;  // diagnostics of the file
};

}  // namespace gs::app
