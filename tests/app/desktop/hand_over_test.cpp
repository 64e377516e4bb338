#include "app/desktop/hand_over.h"

#include "net/control/control_caller.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

namespace gs::app::hand_over_test {

// Environment variable set for the lifetime of this object.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_(name) {
    if (const char* old = std::getenv(name)) before_ = old;
    ::setenv(name, value.c_str(), 1);
  }
  ~Environment() {
    if (before_.empty())
      ::unsetenv(name_);
    else
      ::setenv(name_, before_.c_str(), 1);
  }

 private:
  const char* name_;
  std::string before_;
};

struct Runtime {
  Runtime() { ::chmod(folder.path("").c_str(), 0700); }
  ScratchFolder folder;
  Environment variable{"XDG_RUNTIME_DIR", folder.path("")};
};

TEST_CASE("hands files to the open window of the same user only") {
  const Runtime runtime;
  const std::string folder = hand_over_folder();
  REQUIRE_FALSE(folder.empty());
  CHECK_FALSE(hand_over(folder, {"a.wrl"}));  // no window listens
  std::atomic<bool> woken = false;
  auto window = HandOver::listen(folder, [&] { woken = true; });
  REQUIRE(window);
  CHECK_FALSE(HandOver::listen(folder, [] {}));  // the first window listens there
  HandOver::Taken taken;
  std::atomic<bool> done = false;
  std::thread main_thread([&] {
    while (!done || !taken.asked) {
      if (woken.exchange(false))
        if (auto more = window->take(); more.asked) taken = more;
      if (taken.asked) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  CHECK(hand_over(folder, {"a.wrl", "http://example.org/b.qnv", "ghostspace:http://example.org/c.wrl"}));
  done = true;
  main_thread.join();
  REQUIRE(taken.files.size() == 3);
  CHECK(taken.files[0] == std::filesystem::absolute("a.wrl").string());
  CHECK(taken.files[1] == "http://example.org/b.qnv");
  CHECK(taken.files[2] == "ghostspace:http://example.org/c.wrl");
  // A peer without the token receives nothing and delivers nothing.
  const auto stranger =
      net::call_control(folder + "/window.sock", std::string(32, '0'), "{\"open\":[\"x\"]}", std::chrono::seconds(20));
  const auto* answer = std::get_if<std::string>(&stranger);
  CHECK((!answer || *answer != "taken"));
  CHECK_FALSE(window->take().asked);
  struct stat about {};
  for (const char* name : {"/window.sock", "/window.token"}) {
    REQUIRE(::lstat((folder + name).c_str(), &about) == 0);
    CHECK((about.st_mode & 077) == 0);
  }
  window.reset();
  CHECK_FALSE(hand_over(folder, {"a.wrl"}));
  CHECK(HandOver::listen(folder, [] {}));  // the socket is free again
}

TEST_CASE("Hands over URLs as they are, their scheme in any case (RFC 3986 3.1)") {
  for (const char* url : {"ghostspace:http://a/b.wrl", "GHOSTSPACE:http://a/b.wrl", "HTTP://a/b.wrl"})
    CHECK(absolute_place(url) == url);
  CHECK(absolute_place("ghostspace.wrl").starts_with('/'));
}

TEST_CASE("refuses to hand over through a folder that others may enter") {
  const Runtime runtime;
  const std::string folder = hand_over_folder();
  ::chmod(folder.c_str(), 0755);
  CHECK(hand_over_folder().empty());
  ::chmod(folder.c_str(), 0700);
  CHECK_FALSE(hand_over_folder().empty());
  ::chmod(runtime.folder.path("").c_str(), 0777);
  CHECK(hand_over_folder().empty());
  const Environment none("XDG_RUNTIME_DIR", "relative");
  CHECK(hand_over_folder().empty());
  CHECK_FALSE(HandOver::listen("", [] {}));
}

}  // namespace gs::app::hand_over_test
