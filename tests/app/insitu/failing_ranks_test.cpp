// Failures of one rank between collective functions: no rank may wait for ever, and later steps must work.
#include "app/insitu/insitu_session.h"
#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/insitu/thread_ranks.h"
#include "tests/net/http_client.h"

#include <array>
#include <atomic>
#include <chrono>
#include <new>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app::insitu {
namespace failing_ranks_test {

using namespace test;

/// Results of two steps on three ranks. The work `part` of rank `failing` throws in the first step.
struct FailedRun {
  std::array<std::array<int, 2>, 3> results{};  // of end_step, by rank and step
  std::array<std::string, 3> errors;
  bool threw = false;
};

gs_insitu_cells tetrahedron(const std::vector<float>& points, const std::vector<std::int32_t>& indices,
                            const std::vector<std::int32_t>& offsets, const std::uint8_t& type) {
  gs_insitu_cells cells{};
  cells.size = sizeof cells;
  cells.points = points.data();
  cells.point_type = GS_INSITU_FLOAT32;
  cells.index_type = GS_INSITU_INT32;
  cells.point_count = 4;
  cells.connectivity = indices.data();
  cells.connectivity_count = 4;
  cells.offsets = offsets.data();
  cells.types = &type;
  cells.cell_count = 1;
  return cells;
}

FailedRun run_with_fault(std::string_view part, int failing, std::int64_t edge, bool files) {
  FailedRun run;
  const ScratchFolder scratch;
  std::atomic<bool> threw{false};
  ThreadRanks::run(3, [&](int rank, const gs_insitu_communicator& table) {
    SessionOptions options;
    options.token_file = scratch.path("token");
    options.serve = !files;
    if (files) options.folder = scratch.path("out");
    options.fault = [&, rank](const char* work) {
      if (rank != failing || part != work || threw.exchange(true)) return;
      throw std::bad_alloc();
    };
    auto opened = InSituSession::open(options, &table);
    auto* const session = std::get_if<std::unique_ptr<InSituSession>>(&opened);
    if (!session) return;
    const SmoothGrid grid(edge);
    std::vector<double> values;
    gs_insitu_field field;
    const gs_insitu_block block = grid.block(edge * rank / 3, edge * (rank + 1) / 3, values, field);
    const float at = static_cast<float>(rank);
    const std::vector<float> points{at, 0, 0, at + 1, 0, 0, at, 1, 0, at, 0, 1};
    const std::vector<std::int32_t> indices{0, 1, 2, 3}, offsets{0, 4};
    const std::uint8_t type = 10;
    const gs_insitu_cells cells = tetrahedron(points, indices, offsets, type);
    gs_insitu_particles particles{};
    particles.size = sizeof particles;
    particles.positions = points.data();
    particles.position_type = GS_INSITU_FLOAT32;
    particles.count = 4;
    const auto me = static_cast<std::size_t>(rank);
    // A viewer that changes a parameter makes the second step wanted, but files need none.
    for (std::size_t step = 0; step < 2; ++step) {
      const int begun = (*session)->begin_step(static_cast<std::int64_t>(step), 0);
      if (begun != GS_INSITU_OK) {
        run.results[me][step] = begun;
        continue;
      }
      (void)(*session)->pass_block(block);
      if (files) {
        (void)(*session)->pass_cells(cells);
        (void)(*session)->pass_particles(particles);
      }
      run.results[me][step] = (*session)->end_step();
      if (step == 0) run.errors[me] = (*session)->error();
    }
  });
  run.threw = threw;
  return run;
}

TEST_CASE("in situ: a rank that lacks memory for a step fails it on all ranks, and later steps work") {
  for (const char* part : {"facts", "plan", "grid"})
    for (const int failing : {0, 2}) {
      if (std::string_view(part) == "plan" && failing != 0) continue;
      INFO(part << " on rank " << failing);
      const FailedRun run = run_with_fault(part, failing, 9, true);
      CHECK(run.threw);
      for (std::size_t rank = 0; rank < 3; ++rank) {
        CHECK(run.results[rank][0] == GS_INSITU_FAILED);
        CHECK(run.errors[rank].find("enough memory") != std::string::npos);
        CHECK(run.results[rank][1] == GS_INSITU_OK);
      }
    }
}

TEST_CASE("in situ: a rank that lacks memory for cells or particles does not block the others") {
  for (const char* part : {"cells", "particles", "records", "counts", "surface", "list"})
    for (const int failing : {0, 1}) {
      INFO(part << " on rank " << failing);
      const FailedRun run = run_with_fault(part, failing, 9, true);
      CHECK(run.threw);
      for (std::size_t rank = 0; rank < 3; ++rank) CHECK(run.results[rank][1] == GS_INSITU_OK);
    }
}

TEST_CASE("in situ: a rank that lacks memory for a kept grid fails the step on all ranks") {
  for (const int failing : {0, 1, 2}) {
    INFO(failing);
    const FailedRun run = run_with_fault("keep", failing, 48, false);
    CHECK(run.threw);
    for (std::size_t rank = 0; rank < 3; ++rank) {
      CHECK(run.results[rank][0] == GS_INSITU_FAILED);
      CHECK(run.results[rank][1] == GS_INSITU_OK);  // there is still no step for the first viewer
    }
  }
}

TEST_CASE("in situ: a rank that lacks memory for messages does not block the others") {
  for (const char* part : {"chunks", "message", "deliver", "serve", "decide"})
    for (const int failing : {0, 1}) {
      INFO(part << " on rank " << failing);
      const FailedRun run = run_with_fault(part, failing, 48, false);
      for (std::size_t rank = 1; rank < 3; ++rank) CHECK(run.results[rank] == run.results[0]);
    }
}

/// Requests a chunk of rank 1 while the work `part` of rank `failing` throws once. Returns the HTTP status.
int status_after_fault(std::string_view part, int failing, bool& threw) {
  const ScratchFolder scratch;
  std::atomic<bool> requested{false}, thrown{false}, done{false};
  std::atomic<int> port{0}, status{0};
  std::thread viewer([&] {
    while (port == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto own = static_cast<std::uint16_t>(port.load());
    for (const char* path : {"/", "/heat.000000.zarr/zarr.json"}) (void)net::test::fetch(own, path);
    requested = true;
    // A client repeats a request that the server could not answer in time.
    for (int i = 0; i < 2 && status != 200; ++i) status = net::test::fetch(own, "/heat.000000.zarr/0/c.1.1.1").status;
    done = true;
  });
  ThreadRanks::run(2, [&](int rank, const gs_insitu_communicator& table) {
    SessionOptions options;
    options.token_file = scratch.path("token");
    options.serve = true;
    options.fault = [&, rank](const char* work) {
      if (rank != failing || part != work || !requested || thrown.exchange(true)) return;
      throw std::bad_alloc();
    };
    auto opened = InSituSession::open(options, &table);
    auto* const session = std::get_if<std::unique_ptr<InSituSession>>(&opened);
    if (!session) return;
    gs_insitu_parameter end{};
    end.size = sizeof end;
    end.name = "end";
    end.maximum = 1;
    (void)(*session)->add_parameter(end);
    const SmoothGrid grid(80);
    std::vector<double> values;
    gs_insitu_field field;
    const gs_insitu_block block = grid.block(40 * rank, 40 * (rank + 1), values, field, 1);
    bool asked = false;
    for (std::int64_t step = 0; (*session)->value("end") == 0; ++step) {
      if ((*session)->begin_step(step, 0) == GS_INSITU_OK) {
        (void)(*session)->pass_block(block);
        (void)(*session)->end_step();
      }
      if (rank != 0) continue;
      if (port == 0) port = (*session)->port();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (done && !asked)
        asked = net::test::fetch(static_cast<std::uint16_t>(port.load()), "/parameters?end=1",
                                 {"Authorization: Bearer " + scratch.read("token").substr(0, 32)}, "POST")
                    .status == 200;
    }
  });
  viewer.join();
  threw = thrown;
  return status;
}

TEST_CASE("in situ: a chunk reaches its viewer although a rank once lacked memory for it") {
  for (const char* part : {"decide", "wanted", "chunks", "message", "deliver"}) {
    INFO(part);
    bool threw = false;
    CHECK(status_after_fault(part, 0, threw) == 200);
    CHECK(threw);
  }
}

TEST_CASE("in situ: a session encodes later steps although it lacked memory to start one") {
  const bool background = GENERATE(false, true);
  const ScratchFolder scratch;
  SessionOptions options;
  options.folder = scratch.path("out");
  options.background = background;
  bool threw = false;
  options.fault = [&](const char* work) {
    if (std::string_view(work) != "encode" || std::exchange(threw, true)) return;
    throw std::bad_alloc();
  };
  auto opened = InSituSession::open(options, nullptr);
  auto& session = *std::get<std::unique_ptr<InSituSession>>(opened);
  const SmoothGrid grid(12);
  std::vector<double> values;
  gs_insitu_field field;
  const gs_insitu_block block = grid.block(0, 12, values, field);
  for (std::int64_t step = 0; step < 2; ++step) {
    REQUIRE(session.begin_step(step, 0) == GS_INSITU_OK);
    REQUIRE(session.pass_block(block) == GS_INSITU_OK);
    CHECK(session.end_step() == (step == 0 ? GS_INSITU_FAILED : GS_INSITU_OK));
  }
  REQUIRE(session.flush() == GS_INSITU_OK);
  CHECK(threw);
  CHECK(scratch.read("out/heat.000001.qnv").size() > 100);
}

}  // namespace failing_ranks_test
}  // namespace gs::app::insitu
