#include "app/session/documents/session_log.h"

#include "app/session/session.h"
#include "tests/app/one_world.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <thread>

namespace gs::app::session_log_test {

using Lines = std::vector<std::string>;

Diagnostics said(const Lines& messages) {
  Diagnostics all;
  for (const std::string& message : messages) all.add({Severity::error, "a.wrl", {1, 1}, message});
  return all;
}

TEST_CASE("keeps the messages of each file in the session log, and reports them once") {
  SessionLog log;
  log.note("a.wrl", said({"one"}));
  CHECK(log.take_untold() == Lines{"a.wrl:1:1: error: one"});
  log.note("a.wrl", said({"one", "two"}));
  log.note("b.wrl", said({}));
  CHECK(log.take_untold() == Lines{"a.wrl:1:1: error: two"});
  CHECK(log.errors() == 2);
  CHECK(log.files().size() == 2);
  log.note("a.wrl", said({"three"}));  // the file was read again
  CHECK(log.take_untold() == Lines{"a.wrl:1:1: error: three"});
  CHECK(log.errors() == 1);
  for (std::size_t i = 0; i < 2 * SessionLog::kMaxFiles; ++i) log.note(std::to_string(i), said({"x"}));
  CHECK(log.files().size() == SessionLog::kMaxFiles);
  CHECK(log.errors() == SessionLog::kMaxFiles);
}

Frame steps_until(Session& session, const std::function<bool(const Frame&)>& done) {
  SessionInput input;
  input.area = Viewport{0, 0, 200, 100};
  for (int i = 0; i < 2000; ++i) {
    Frame frame = session.step(world_time(), input);
    if (done(frame)) return frame;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  FAIL("it never comes");
  return {};
}

TEST_CASE("keeps failed files in the log while another one shows, and reports each") {
  const ScratchFolder folder;
  const std::string good =
      folder.write("good.wrl", "#VRML V2.0 utf8\nShape { geometry Box { } }\nNoSuchNode { } NoSuchNode { }\n");
  const std::string missing = folder.path("missing.wrl"), other = folder.path("other.wrl");
  Session session({}, {}, {});
  session.opening().open_files({missing});
  const Frame first = steps_until(session, [](const Frame& frame) { return !frame.failed.empty(); });
  CHECK(first.failed[0].path == missing);
  REQUIRE(session.panes().at(0).failure);  // the viewport shows the same failure
  CHECK(session.panes().at(0).failure->path == missing);
  session.opening().open_files({other, good});
  bool failed = false, arrived = false;
  (void)steps_until(session, [&](const Frame& frame) {
    failed = failed || !frame.failed.empty();
    arrived = arrived || std::find(frame.arrived.begin(), frame.arrived.end(), good) != frame.arrived.end();
    return failed && arrived;
  });
  REQUIRE(session.log().files().size() == 3);
  CHECK(session.log().files()[0].path == missing);
  // Reports each ignored node type once.
  CHECK(session.log().errors() == 3);
}

}  // namespace gs::app::session_log_test
