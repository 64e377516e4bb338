#include "app/session/documents/folder_questions.h"

#include <catch2/catch.hpp>

using namespace gs::app;

TEST_CASE("asks once per folder, and reads worlds again after permission") {
  FolderQuestions questions;
  CHECK(questions.current() == nullptr);
  CHECK(questions.answer(true).empty());
  questions.ask("a.wrl", {{"/w/textures", "../textures/x.png"}, {"/etc", "/etc/passwd"}});
  questions.ask("b.wrl", {{"/w/textures", "../textures/y.png"}});
  questions.ask("a.wrl", {{"/w/textures", "../textures/x.png"}});
  REQUIRE(questions.current());
  CHECK(questions.current()->folder == "/w/textures");
  CHECK(questions.current()->reference == "../textures/x.png");
  CHECK(questions.answer(true) == std::vector<std::string>{"a.wrl", "b.wrl"});
  CHECK(questions.allowed() == std::vector<std::string>{"/w/textures"});
  REQUIRE(questions.current());
  CHECK(questions.current()->folder == "/etc");
  CHECK(questions.answer(false).empty());
  CHECK(questions.current() == nullptr);
  // Answers hold for the session.
  questions.ask("c.wrl", {{"/etc", "/etc/hosts"}, {"/w/textures", "../textures/z.png"}});
  CHECK(questions.current() == nullptr);
  CHECK(questions.allowed() == std::vector<std::string>{"/w/textures"});
}
