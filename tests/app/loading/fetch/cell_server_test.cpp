// Tests of cell servers that stop, are killed or change.
#include "tests/app/loading/fetch/cell_site.h"

#include <catch2/catch.hpp>

using namespace gs;
using namespace gs::app;

namespace {

/// Returns the world after the server stops half-way and `then` runs.
template <class Then>
LoadedWorld interrupted(CellSite& site, const LoadOptions& options, const Then& then) {
  WorldLoading loading(site.url("packed.qnv"), options);
  while (!loading.done() && loading.state().received < 100'000) (void)loading.step(kCellWait);
  REQUIRE_FALSE(loading.done());
  then();
  while (!loading.done()) (void)loading.step(kCellWait);
  LoadedWorld world = loading.take();
  for (const auto& feed : world.feeds) (void)feed->apply();
  return world;
}

/// Server in its own process, which a test can kill. The first server sends slowly, the second one replaces it.
class ServerProgram {
 public:
  explicit ServerProgram(const CellSite& site, const char* rate = "2000000") {
    const std::string port = std::to_string(*site.options.cells_port), folder = site.folder.path("");
    process_ = ::fork();
    if (process_ != 0) return;
    ::execl(program().c_str(), "ghostspace", "serve", "--cells", port.c_str(), "--rate", rate, folder.c_str(),
            static_cast<char*>(nullptr));
    ::_exit(127);
  }
  ServerProgram(const ServerProgram&) = delete;
  ServerProgram& operator=(const ServerProgram&) = delete;
  ~ServerProgram() {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

 private:
  pid_t process_ = -1;
};

}  // namespace

TEST_CASE("keeps the received part when a cell server stops") {
  CellSite site;
  site.options.rate = 2'000'000;
  site.start();
  LoadOptions options;
  options.timeout_seconds = 60;
  const LoadedWorld world = interrupted(site, options, [&] { site.archive.reset(); });
  CHECK(tells(world.diagnostics, "the server is stopping"));
  REQUIRE(world.scene);
  CHECK(world.truncated);
  CHECK(geometry_of_world(world).size() > 1000);
}

TEST_CASE("asks a killed cell server again, and detects a changed file") {
  CellSite site;
  site.start();
  site.archive.reset();  // the port is free
  auto server = std::make_unique<ServerProgram>(site);
  LoadOptions options;
  options.timeout_seconds = 120;
  SECTION("the same file: what is there stays") {
    const LoadedWorld world = interrupted(site, options, [&] {
      server.reset();
      server = std::make_unique<ServerProgram>(site, "20000000");
    });
    CHECK(world.diagnostics.errors() == 0);
    CHECK(geometry_of_world(world).size() > 500'000);
  }
  SECTION("another one") {
    const LoadedWorld world = interrupted(site, options, [&] {
      server.reset();
      site.folder.write("packed.qnv", large_stream().substr(0, large_stream().size() / 2));
      server = std::make_unique<ServerProgram>(site);
    });
    CHECK(tells(world.diagnostics, "changed on the server"));
    REQUIRE(world.scene);
    CHECK(world.truncated);
    CHECK(geometry_of_world(world).size() > 1000);
  }
}
