#include "app/desktop/file_dialog.h"
#include "base/noncopyable.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <semaphore>
#include <string>
#include <vector>

namespace gs::app::file_dialog_test {
namespace {

using Files = std::vector<std::string>;

/// Desktop substitute for the lifetime of this object.
struct Desktop : NonCopyable {
  Desktop() {
    if (const char* value = std::getenv("DISPLAY")) before = value;
    ::setenv("DISPLAY", ":of-a-test", 1);
  }
  ~Desktop() {
    if (before.empty())
      ::unsetenv("DISPLAY");
    else
      ::setenv("DISPLAY", before.c_str(), 1);
  }
  std::string before;
};

FileDialog::Answer answer_of(const std::string& script) {
  const std::vector<DialogProgram> programs = {{"/nowhere/at/all", {}}, {"/bin/sh", {"-c", script}}};
  std::binary_semaphore woken{0};
  FileDialog dialog([&] { woken.release(); }, programs);
  REQUIRE(dialog.show());
  CHECK(dialog.show());  // already shown
  woken.acquire();
  const auto answer = dialog.take();
  REQUIRE(answer);
  CHECK_FALSE(dialog.is_shown());
  return *answer;
}

}  // namespace

TEST_CASE("returns the chosen files of the desktop's dialog, one per line") {
  const Desktop desktop;
  CHECK(answer_of("echo '/a.wrl'; echo '/b c.wrl'").files == Files{"/a.wrl", "/b c.wrl"});
  const auto none = answer_of("exit 1");  // the user cancelled
  CHECK(none.files.empty());
  CHECK_FALSE(none.failed);
  const auto broken = answer_of("echo /a.wrl; exit 5");
  CHECK(broken.files.empty());
  CHECK(broken.failed);
  CHECK(answer_of("kill -9 $$").failed);
}

TEST_CASE("opens the desktop's dialog in the given folder, and prints nothing") {
  const Desktop desktop;
  const std::vector<DialogProgram> programs = {
      {"/bin/sh", {"-c", "echo \"$0\"; echo \"$1\"; readlink /proc/self/fd/2", "--in={folder}/", "{folder}"}}};
  std::binary_semaphore woken{0};
  FileDialog dialog([&] { woken.release(); }, programs);
  REQUIRE(dialog.show("/a b/c"));
  woken.acquire();
  CHECK(dialog.take()->files == Files{"--in=/a b/c/", "/a b/c", "/dev/null"});
}

TEST_CASE("asks for a file to save with a program that can, and reports it") {
  const Desktop desktop;
  const std::vector<DialogProgram> programs = {{"/bin/sh", {"-c", "echo open"}},
                                               {"/bin/sh", {"-c", "echo open"}, {"-c", "echo \"$0\"", "{file}"}}};
  std::binary_semaphore woken{0};
  FileDialog dialog([&] { woken.release(); }, programs);
  REQUIRE(dialog.show_saving("/a b/c.wrl"));
  woken.acquire();
  const auto answer = dialog.take();
  REQUIRE(answer);
  CHECK(answer->files == Files{"/a b/c.wrl"});
  CHECK(answer->saves);
  for (const DialogProgram& known : dialog_programs()) CHECK_FALSE(known.save_arguments.empty());
}

TEST_CASE("closes the dialog with its window, and runs without one") {
  const Desktop desktop;
  const std::vector<DialogProgram> patient = {{"/bin/sh", {"-c", "exec sleep 1000"}}};
  {
    FileDialog dialog([] {}, patient);
    REQUIRE(dialog.show());
    CHECK_FALSE(dialog.take());
  }
  FileDialog nothing([] {}, {});
  CHECK_FALSE(nothing.show());
  CHECK_FALSE(nothing.take());
}

}  // namespace gs::app::file_dialog_test
