#include "app/inspect/console.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

namespace gs::app::script_console_test {

std::vector<std::string> texts(const ScriptConsole& console) {
  std::vector<std::string> all;
  for (const ProgramLine& one : console.lines()) all.push_back(one.place + "|" + one.text);
  return all;
}
using Texts = std::vector<std::string>;

TEST_CASE("shows log lines of programs once, with their position") {
  SessionLog log;
  Diagnostics said;
  said.add({Severity::note, "print", {}, "hello"});
  said.add({Severity::warning, "/worlds/a.wrl", {3, 4}, "unknown field 'x'"});
  said.add({Severity::error, "/worlds/a.wrl", {7, 12}, "Script Door: ReferenceError: y is not defined"});
  log.note("a.wrl", said);
  ScriptConsole console;
  CHECK(console.take(log, "a.wrl"));
  CHECK(texts(console) == Texts{"|hello", "a.wrl:7:12|Script Door: ReferenceError: y is not defined"});
  CHECK(console.lines()[0].kind == ProgramLine::Kind::printed);
  CHECK(console.lines()[1].kind == ProgramLine::Kind::problem);
  CHECK_FALSE(console.take(log, "a.wrl"));
  said.add({Severity::note, "print", {}, "again"});
  log.note("a.wrl", said);
  CHECK(console.take(log, "a.wrl"));
  CHECK(texts(console).size() == 3);
  // Another world.
  CHECK(console.take(log, "b.wrl"));
  CHECK(console.lines().empty());
}

TEST_CASE("recalls entered lines by the arrow keys, and the line in progress") {
  ScriptConsole console;
  CHECK_FALSE(console.enter("  "));
  CHECK_FALSE(console.recall(true, ""));
  CHECK(console.enter("1 + 1"));
  console.answer("2", false);
  CHECK(console.enter("Browser"));
  console.answer("no", true);
  CHECK(texts(console) == Texts{"|1 + 1", "|2", "|Browser", "|no"});
  CHECK(console.lines()[3].kind == ProgramLine::Kind::failure);
  CHECK(console.recall(true, "beg") == "Browser");
  CHECK(console.recall(true, "Browser") == "1 + 1");
  CHECK_FALSE(console.recall(true, "1 + 1"));
  CHECK(console.recall(false, "1 + 1") == "Browser");
  CHECK(console.recall(false, "Browser") == "beg");
  CHECK_FALSE(console.recall(false, "beg"));
  // A repeated line occurs once.
  CHECK(console.enter("1 + 1"));
  CHECK(console.recall(true, "") == "1 + 1");
  CHECK(console.recall(true, "") == "Browser");
  CHECK_FALSE(console.recall(true, ""));
}

TEST_CASE("limits the number of lines and entries") {
  ScriptConsole console;
  for (std::size_t i = 0; i < 2 * ScriptConsole::kMaxLines; ++i) console.answer(std::to_string(i), false);
  CHECK(console.lines().size() <= ScriptConsole::kMaxLines);
  CHECK(console.lines().back().text == std::to_string(2 * ScriptConsole::kMaxLines - 1));
  for (std::size_t i = 0; i <= ScriptConsole::kMaxEntered; ++i) (void)console.enter(std::to_string(i));
  std::size_t entered = 0;
  while (console.recall(true, "")) ++entered;
  CHECK(entered == ScriptConsole::kMaxEntered);
}

}  // namespace gs::app::script_console_test
