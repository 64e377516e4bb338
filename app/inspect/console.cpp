#include "app/inspect/console.h"

#include <algorithm>
#include <utility>

namespace gs::app {
namespace {

// Converts a diagnostic about a Script's program to a console line. Returns nullopt for other diagnostics.
std::optional<ProgramLine> line_of(const Diagnostic& one) {
  if (one.severity == Severity::note && one.file == "print")
    return ProgramLine{ProgramLine::Kind::printed, {}, one.message};
  if (!one.message.starts_with("Script: ") &&
      !(one.message.starts_with("Script ") && one.message.find(": ") != std::string::npos))
    return std::nullopt;
  std::string place = one.file.substr(one.file.rfind('/') + 1);
  if (one.location.line > 0)
    place += ":" + std::to_string(one.location.line) + ":" + std::to_string(one.location.column);
  return ProgramLine{ProgramLine::Kind::problem, std::move(place), one.message};
}

}  // namespace

void ScriptConsole::add(ProgramLine line) {
  if (lines_.size() >= kMaxLines) lines_.erase(lines_.begin(), lines_.begin() + kMaxLines / 4);
  lines_.push_back(std::move(line));
}

bool ScriptConsole::take(const SessionLog& log, const std::string& path) {
  const auto& files = log.files();
  const auto file =
      std::find_if(files.begin(), files.end(), [&](const SessionLog::File& one) { return one.path == path; });
  const std::size_t count = file == files.end() ? 0 : file->diagnostics.entries().size();
  bool changed = false;
  if (path != path_ || count < taken_) {
    changed = !lines_.empty();
    path_ = path;
    taken_ = 0;
    lines_.clear();
  }
  for (; taken_ < count; ++taken_)
    if (auto line = line_of(file->diagnostics.entries()[taken_])) {
      add(std::move(*line));
      changed = true;
    }
  return changed;
}

bool ScriptConsole::enter(const std::string& line) {
  if (line.find_first_not_of(" \t\r\n") == std::string::npos) return false;
  std::erase(entered_, line);
  if (entered_.size() >= kMaxEntered) entered_.erase(entered_.begin());
  entered_.push_back(line);
  recalled_ = entered_.size();
  edited_.clear();
  waiting_.push_back(line);
  add({ProgramLine::Kind::entered, {}, line});
  return true;
}

void ScriptConsole::answer(const std::string& text, bool failed) {
  add({failed ? ProgramLine::Kind::failure : ProgramLine::Kind::result, {}, text});
}

std::optional<std::string> ScriptConsole::recall(bool before, const std::string& present) {
  recalled_ = std::min(recalled_, entered_.size());
  if (before ? recalled_ == 0 : recalled_ == entered_.size()) return std::nullopt;
  if (recalled_ == entered_.size()) edited_ = present;
  recalled_ = before ? recalled_ - 1 : recalled_ + 1;
  return recalled_ == entered_.size() ? edited_ : entered_[recalled_];
}

}  // namespace gs::app
