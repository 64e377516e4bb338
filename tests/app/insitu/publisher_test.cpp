#include "app/insitu/publisher.h"
#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/insitu/thread_ranks.h"
#include "tests/net/http_client.h"

#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <map>
#include <string>
#include <thread>
#include <vector>

namespace gs::app::insitu {
namespace publisher_test {

using namespace test;
using net::test::fetch;
using net::test::Got;

/// Simulation that serves its steps, with a parameter and two fields.
struct ServedRun {
  explicit ServedRun(double share = 0) : token_file(scratch.path("token")) {
    gs_insitu_options options = plain_options();
    options.serve = 1;
    options.token_file = token_file.c_str();
    options.max_share = share;
    session = opened(options);
    gs_insitu_parameter feed{};
    feed.size = sizeof feed;
    feed.name = "feed";
    feed.maximum = 1;
    feed.value = 0.25;
    REQUIRE(gs_insitu_add_parameter(session.get(), &feed) == GS_INSITU_OK);
    port = static_cast<std::uint16_t>(gs_insitu_port(session.get()));
    REQUIRE(port != 0);
    token = scratch.read("token").substr(0, 32);
  }
  // Runs one step. Returns true if it was taken.
  bool step() {
    const int number = next++;
    if (gs_insitu_begin_step(session.get(), number, number) != GS_INSITU_OK) return false;
    gs_insitu_field fields[2]{};
    gs_insitu_block block = grid.block(0, grid.n, values, fields[0]);
    fields[1] = fields[0];
    fields[1].name = "other";
    block.fields = fields;
    block.field_count = 2;
    REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
    REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
    return true;
  }
  // Runs steps until one is taken.
  bool step_taken() {
    for (int i = 0; i < 1'000'000; ++i)
      if (step()) return true;
    return false;
  }
  [[nodiscard]] Got get(const std::string& target) const { return fetch(port, target); }
  [[nodiscard]] Got post(const std::string& target, const std::string& secret) const {
    return fetch(port, target, {"Authorization: Bearer " + secret}, "POST");
  }

  ScratchFolder scratch;
  std::string token_file, token;
  Session session;
  std::uint16_t port = 0;
  SmoothGrid grid{12};
  std::vector<double> values;
  int next = 0;
};

TEST_CASE("in situ server: the root is a world that shows the newest stream") {
  ServedRun run;
  CHECK(run.get("/").body.find("QNV") == std::string::npos);
  REQUIRE(run.step());
  const Got world = run.get("/");
  CHECK(world.status == 200);
  CHECK(world.headers.at("content-type") == "model/vrml");
  CHECK(world.body.starts_with("#VRML V2.0 utf8"));
  CHECK(world.body.find("live data: insitu.json") != std::string::npos);
  CHECK(world.body.find("url \"heat.000000.qnv\"") != std::string::npos);
  const Got stream = run.get("/heat.000000.qnv");
  CHECK(stream.status == 200);
  const DecodedVolume decoded = decoded_volume(stream.body);
  CHECK(decoded.values.at(1) == Approx(run.grid.at(1, 0, 0)).margin(decoded.error));
  REQUIRE(run.step_taken());
  CHECK(run.get("/").headers.at("etag") != world.headers.at("etag"));
  CHECK(run.get("/heat.000000.qnv").status == 200);  // a slow viewer may still read it
  CHECK(run.get("/other.000000.qnv").status == 404);
}

TEST_CASE("in situ server: no step is taken until a viewer has asked for the one before") {
  ServedRun run;
  REQUIRE(run.step());
  for (int i = 0; i < 100; ++i) CHECK_FALSE(run.step());
  (void)run.get("/");
  for (int i = 0; i < 100; ++i) CHECK_FALSE(run.step());
  (void)run.get("/heat.000000.qnv");
  CHECK(run.step_taken());
}

TEST_CASE("in situ server: viewers change parameters with the token only") {
  ServedRun run;
  REQUIRE(run.step());
  REQUIRE(run.token.size() == 32);
  CHECK((std::filesystem::status(run.token_file).permissions() & std::filesystem::perms::all) ==
        (std::filesystem::perms::owner_read | std::filesystem::perms::owner_write));
  CHECK(run.post("/parameters?feed=0.5", "0123").status == 403);
  CHECK(fetch(run.port, "/parameters?feed=0.5", {}, "POST").status == 403);
  CHECK(run.get("/parameters?feed=0.5").status == 404);
  CHECK(run.post("/parameters?feed=7", run.token).status == 400);
  CHECK(run.post("/parameters?feed=7", run.token).body == "feed: the value is out of range; expected 0 to 1\n");
  CHECK(run.post("/other?feed=0.5", run.token).status == 404);
  CHECK(run.post("/parameters?feed=0.5", run.token).status == 200);
  CHECK(gs_insitu_value(run.session.get(), "feed") == 0.25);
  CHECK(run.step_taken());  // a change needs a new picture
  CHECK(gs_insitu_value(run.session.get(), "feed") == 0.5);
  CHECK(std::isnan(gs_insitu_value(run.session.get(), "none")));
  const std::string json = run.get("/insitu.json").body;
  CHECK(json.find("\"feed\"") != std::string::npos);
  CHECK(json.find("0.5") != std::string::npos);
  CHECK(json.find(run.token) == std::string::npos);
}

TEST_CASE("in situ server: viewers choose the field") {
  ServedRun run;
  REQUIRE(run.step());
  CHECK(run.get("/insitu.json").body.find("\"other\"") != std::string::npos);
  CHECK(run.post("/parameters?field=none", run.token).status == 400);
  CHECK(run.post("/parameters?field=other", run.token).status == 200);
  REQUIRE(run.step_taken());
  CHECK(run.get("/").body.find("url \"other.") != std::string::npos);
}

// Serves a grid of 80^3 points that `ranks` ranks keep, and returns the bodies of all chunks and of the world.
std::map<std::string, std::string> served_chunks(int ranks) {
  std::map<std::string, std::string> bodies;
  std::atomic<bool> done{false};
  std::atomic<int> port{0};
  const ScratchFolder scratch;
  const std::string token_file = scratch.path("token");
  std::thread viewer([&] {
    while (port == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    for (const char* path : {"/", "/heat.000000.zarr/zarr.json", "/heat.000000.zarr/0/c.0.0.0",
                             "/heat.000000.zarr/0/c.1.1.1", "/heat.000000.zarr/1/c.0.0.0", "/insitu.json"}) {
      const Got got = fetch(static_cast<std::uint16_t>(port.load()), path);
      bodies[path] = got.status == 200 ? got.body : "status " + std::to_string(got.status);
    }
    done = true;
  });
  ThreadRanks::run(ranks, [&](int rank, const gs_insitu_communicator& table) {
    gs_insitu_options options = plain_options();
    options.serve = 1;
    options.token_file = token_file.c_str();
    Session session(gs_insitu_open(&options, &table, nullptr, 0));
    const SmoothGrid grid(80);
    std::vector<double> values;
    gs_insitu_field field;
    const gs_insitu_block block = grid.block(80 * rank / ranks, 80 * (rank + 1) / ranks, values, field, 1);
    // Rank 0 ends the run after serving the viewer. All ranks agree on the number of the last step.
    const gs_insitu_parameter end{sizeof end, "end", nullptr, nullptr, 0, 1, 0, 0, 0};
    (void)gs_insitu_add_parameter(session.get(), &end);
    bool asked = false;
    for (int step = 0; gs_insitu_value(session.get(), "end") == 0; ++step) {
      if (gs_insitu_begin_step(session.get(), step, step) == GS_INSITU_OK) {
        (void)gs_insitu_pass_block(session.get(), &block);
        (void)gs_insitu_end_step(session.get());
      }
      if (rank != 0) continue;
      if (port == 0) port = gs_insitu_port(session.get());
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      if (done && !asked)
        asked = fetch(static_cast<std::uint16_t>(port.load()), "/parameters?end=1",
                      {"Authorization: Bearer " + scratch.read("token").substr(0, 32)}, "POST")
                    .status == 200;
    }
  });
  viewer.join();
  return bodies;
}

TEST_CASE("in situ server: chunks of a kept grid are the same for every number of ranks") {
  const auto alone = served_chunks(1);
  REQUIRE(alone.size() == 6);
  CHECK(alone.at("/").find("url \"heat.000000.zarr/zarr.json\" profile \"VOLUME\"") != std::string::npos);
  for (const auto& [path, body] : alone) {
    INFO(path);
    CHECK_FALSE(body.starts_with("status"));
  }
  const auto three = served_chunks(3);
  for (const char* path :
       {"/heat.000000.zarr/zarr.json", "/heat.000000.zarr/0/c.0.0.0", "/heat.000000.zarr/1/c.0.0.0"}) {
    INFO(path);
    CHECK(alone.at(path).size() > 100);
    CHECK_FALSE(three.at(path).starts_with("status"));
  }
  CHECK(three.at("/heat.000000.zarr/zarr.json") == alone.at("/heat.000000.zarr/zarr.json"));
}

TEST_CASE("in situ server: a kept grid is not encoded without a request, and the next step waits for one") {
  ServedRun run;
  run.grid = SmoothGrid(48);
  REQUIRE(run.step());
  gs_insitu_statistics numbers{};
  numbers.size = sizeof numbers;
  REQUIRE(gs_insitu_get_statistics(run.session.get(), &numbers) == GS_INSITU_OK);
  CHECK(numbers.stream_bytes == 0);
  CHECK(numbers.peak_bytes == 48 * 48 * 48 * 2);
  (void)run.get("/");
  (void)run.get("/heat.000000.zarr/zarr.json");
  for (int i = 0; i < 100; ++i) CHECK_FALSE(run.step());
  const Got chunk = run.get("/heat.000000.zarr/0/c.0.0.0");
  CHECK(chunk.status == 200);
  CHECK(run.step_taken());
  REQUIRE(gs_insitu_get_statistics(run.session.get(), &numbers) == GS_INSITU_OK);
  CHECK(numbers.stream_bytes == chunk.body.size());
  CHECK(run.get("/heat.000000.zarr/0/c.0.0.0").body == chunk.body);
}

TEST_CASE("in situ server: the token file and the temporary folder end with the session") {
  std::string token_file;
  {
    ServedRun run;
    token_file = run.token_file;
    CHECK(std::filesystem::exists(token_file));
    run.session.reset();
    CHECK_FALSE(std::filesystem::exists(token_file));
  }
}

TEST_CASE("in situ server: a session leaves the live file of a later run") {
  const ScratchFolder scratch;
  const std::string live_file = scratch.path("run.live");
  std::vector<std::string> token_files;
  const auto open = [&] {
    token_files.push_back(scratch.path("token" + std::to_string(token_files.size())));
    gs_insitu_options options = plain_options();
    options.serve = 1;
    options.token_file = token_files.back().c_str();
    options.live_file = live_file.c_str();
    return opened(options);
  };
  Session first = open(), second = open();
  first.reset();
  CHECK(std::filesystem::exists(live_file));
  second.reset();
  CHECK_FALSE(std::filesystem::exists(live_file));
}

TEST_CASE("in situ server: names of fields cannot leave the folder or the world") {
  StepStream stream;
  stream.field = "../a \"b\"/c";
  CHECK(stream_file_name(stream, 12) == "___a__b__c.000012.qnv");
  stream.kind = StreamKind::surface;
  CHECK(stream_file_name(stream, 1'234'567) == "___a__b__c-surface.1234567.qnv");
  stream.field.clear();
  CHECK(stream_file_name(stream, 0) == "surface.000000.qnv");
  CHECK(stream_file_name(stream, 0, {"surface.000000.qnv"}) == "surface-2.000000.qnv");
  const std::string world = world_of_streams("a \" ] \\ \n", 1, 0.5, {stream}, {"surface.000001.qnv"});
  CHECK(world.find("title \"a \\\" ] \\\\ , step 1, time 0.5\"") != std::string::npos);
}

}  // namespace publisher_test
}  // namespace gs::app::insitu
