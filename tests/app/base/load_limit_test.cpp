#include "app/base/load_limit.h"

#include "app/formats/qnv/geometry_reader.h"
#include "app/loading/world_loader.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>

namespace {

using namespace gs;
using namespace gs::app;
using Clock = std::chrono::steady_clock;

}  // namespace

TEST_CASE("stops loading at the time limit or on cancellation") {
  CHECK(LoadLimit(Clock::now() - std::chrono::seconds(1)).over());
  CHECK_FALSE(LoadLimit(Clock::now() + std::chrono::hours(1)).over());
  std::atomic<bool> cancelled = false;
  const LoadLimit limit(Clock::now() + std::chrono::hours(1), &cancelled);
  CHECK_FALSE(limit.over());
  cancelled = true;
  CHECK(limit.over());
}

TEST_CASE("stops running work at its deadline or on cancellation") {
  std::atomic<bool> cancelled = false;
  Deadline deadline(LoadLimit(Clock::now() + std::chrono::hours(1), &cancelled));
  CHECK_FALSE(deadline.progress.cancelled);
  cancelled = true;
  while (!deadline.progress.cancelled) std::this_thread::yield();
  Deadline late(LoadLimit(Clock::now() - std::chrono::seconds(1)));
  while (!late.progress.cancelled) std::this_thread::yield();
}

TEST_CASE("stops reading a world when its loading is cancelled") {
  const ScratchFolder folder;
  const std::string blanks(std::size_t{20} << 20, '\n');  // longer than the part that one step parses
  const std::string path = folder.write("long.wrl", "#VRML V2.0 utf8\nGroup {}\n" + blanks + "Shape {}\n");
  CHECK(load_world(path).scene->roots().size() == 2);
  const std::atomic<bool> cancelled = true;
  LoadOptions options;
  options.cancelled = &cancelled;
  const LoadedWorld world = load_world(path, options);
  CHECK(world.truncated);
  CHECK(world.scene->roots().size() == 1);
}
