#include "app/insitu/bricks/brick_shelf.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>
#include <vector>

namespace gs::app::insitu {
namespace brick_shelf_test {

using State = net::HeldContent::State;

/// Shelf with a switch for the share of run time.
struct TestShelf {
  // Adds a step. With `here`, this process has all chunks.
  void put(const std::string& name, bool here) {
    ServedGrid grid;
    grid.serial = ++serial;
    grid.container = name;
    grid.pyramid = Pyramid({edge, edge, edge});
    grid.grid.field = "heat";
    if (here)
      grid.read = [this](const Chunk&, std::uint32_t first, std::span<float> values) {
        if (first == 0) ++reads;
        std::ranges::fill(values, 1);
      };
    shelf.put(std::move(grid));
  }
  [[nodiscard]] State state(const std::string& path) { return shelf.content(path).state; }

  bool permits = true;
  int reads = 0;
  std::uint32_t edge = 100;
  std::size_t charged = 0;
  std::uint64_t serial = 0;
  BrickShelf shelf{{[this] { return permits; }, [this](double, std::size_t bytes) { charged += bytes; }}};
};

TEST_CASE("in situ shelf: chunks are encoded once, when they are requested") {
  TestShelf test;
  CHECK(test.shelf.is_seen());
  test.put("a.zarr", true);
  CHECK_FALSE(test.shelf.is_seen());
  CHECK(test.state("a.zarr/zarr.json") == State::ready);
  CHECK(test.state("a.zarr/0/zarr.json") == State::ready);
  CHECK(test.reads == 0);
  CHECK(test.state("a.zarr/1/c.0.0.0") == State::ready);
  CHECK(test.shelf.is_seen());
  CHECK(test.state("a.zarr/0/c.1.1.1") == State::ready);
  CHECK(test.state("a.zarr/0/c.1.1.1") == State::ready);
  CHECK(test.reads == 2);
  CHECK(test.charged > 0);
  for (const char* path : {"a.zarr/2/zarr.json", "a.zarr/0/c.2.0.0", "other"}) CHECK(test.state(path) == State::none);
  CHECK(test.state("b.zarr/zarr.json") == State::gone);
}

TEST_CASE("in situ shelf: requests wait for the share of run time") {
  TestShelf test;
  test.put("a.zarr", true);
  test.permits = false;
  CHECK(test.state("a.zarr/0/c.0.0.0") == State::waiting);
  CHECK(test.reads == 0);
  CHECK(test.state("a.zarr/1/c.0.0.0") == State::ready);  // the overview does not wait
  test.permits = true;
  CHECK(test.state("a.zarr/0/c.0.0.0") == State::ready);
}

TEST_CASE("in situ shelf: chunks that ranks sent and viewers no longer want need bounded memory") {
  TestShelf test;
  test.edge = 300;  // 125 chunks of 1 MiB
  test.put("a.zarr", false);
  const std::vector<float> values(Pyramid({300, 300, 300}).chunk_points(0), 1);
  for (std::uint32_t i = 0; i < 20; ++i) {
    const Chunk chunk{0, {i % 5, i / 5, 0}};
    const std::string path = "a.zarr/0/c.0." + std::to_string(i / 5) + "." + std::to_string(i % 5);
    CHECK(test.state(path) == State::waiting);
    REQUIRE(test.shelf.take_wanted(8).size() == 1);
    test.shelf.deliver({1, chunk}, values);
  }
  CHECK(test.state("a.zarr/0/c.0.3.4") == State::ready);
  // The first chunks were dropped, so the ranks send them again.
  CHECK(test.state("a.zarr/0/c.0.0.0") == State::waiting);
  CHECK(test.shelf.take_wanted(8).size() == 1);
}

TEST_CASE("in situ shelf: requests wait for the chunks of other ranks, the coarsest first") {
  TestShelf test;
  test.put("a.zarr", false);
  CHECK(test.state("a.zarr/0/c.0.0.1") == State::waiting);
  CHECK(test.state("a.zarr/1/c.0.0.0") == State::waiting);
  CHECK(test.shelf.is_busy(BrickShelf::Clock::now()));
  const auto wanted = test.shelf.take_wanted(8);
  REQUIRE(wanted.size() == 2);
  CHECK(wanted[0].chunk == Chunk{1, {0, 0, 0}});
  CHECK(wanted[1].chunk == Chunk{0, {1, 0, 0}});
  CHECK(test.shelf.take_wanted(8).empty());
  CHECK(test.state("a.zarr/0/c.0.0.1") == State::waiting);
  CHECK(test.shelf.take_wanted(8).empty());  // the ranks already send it
  test.shelf.deliver(wanted[1], std::vector<float>(64 * 64 * 64, 2));
  CHECK(test.state("a.zarr/0/c.0.0.1") == State::ready);
  test.shelf.deliver({99, {0, {0, 0, 0}}}, {1});  // for a step that was dropped
}

TEST_CASE("in situ shelf: the two newest steps are kept") {
  TestShelf test;
  for (const char* name : {"a.zarr", "b.zarr", "c.zarr"}) test.put(name, true);
  CHECK(test.state("a.zarr/zarr.json") == State::gone);
  CHECK(test.state("b.zarr/0/c.0.0.0") == State::ready);
  CHECK(test.state("c.zarr/0/c.0.0.0") == State::ready);
  test.shelf.drop_older();
  CHECK(test.state("b.zarr/0/c.0.0.0") == State::gone);
  CHECK(test.state("c.zarr/0/c.0.0.0") == State::ready);
  CHECK(test.reads == 2);
}

TEST_CASE("in situ shelf: a step is kept while viewers refine it, but not for ever") {
  TestShelf test;
  test.put("a.zarr", true);
  const auto now = BrickShelf::Clock::now();
  (void)test.shelf.content("a.zarr/1/c.0.0.0");
  CHECK_FALSE(test.shelf.is_busy(now));
  (void)test.shelf.content("a.zarr/0/c.0.0.0");
  CHECK(test.shelf.is_busy(BrickShelf::Clock::now()));
  CHECK_FALSE(test.shelf.is_busy(BrickShelf::Clock::now() + std::chrono::seconds(1)));
  test.permits = false;
  CHECK_FALSE(test.shelf.is_busy(now + std::chrono::seconds(60)));
}

}  // namespace brick_shelf_test
}  // namespace gs::app::insitu
