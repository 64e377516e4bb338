#include "app/commands/common/input_surface.h"

#include <catch2/catch.hpp>

#include <vector>

using namespace gs;
using namespace gs::app;

TEST_CASE("advances the progress while a surface is read, and only in that stage") {
  InputSurface surface;
  surface.triangles = 4;
  surface.source = [](const qnv::TriangleSink& sink) {
    const std::vector<qnv::Triangle> two(2);
    return sink(two) && sink(two);
  };
  Progress progress;
  std::vector<std::uint64_t> done, totals;
  const qnv::TriangleSink sink = [&](std::span<const qnv::Triangle>) {
    done.push_back(progress.done);
    totals.push_back(progress.total);
    return true;
  };
  progress.stage = "reading";
  CHECK(with_progress(surface, progress)(sink));
  CHECK(done == std::vector<std::uint64_t>{2, 4});
  CHECK(totals == std::vector<std::uint64_t>{4, 4});
  CHECK(progress.total == 0);
  progress.stage = "cutting";
  progress.total = 9;
  CHECK(with_progress(surface, progress)(sink));
  CHECK(totals.back() == 9);
}

TEST_CASE("refuses to join more triangles than the memory limit allows") {
  InputSurface surface;
  surface.source = [](const qnv::TriangleSink& sink) {
    qnv::Triangle one;
    one.positions = {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
    const std::vector<qnv::Triangle> many(10, one);
    return sink(many);
  };
  ProgressBar progress;
  CHECK(std::holds_alternative<qnv::IndexedMesh>(indexed_mesh(surface, 10, progress)));
  const auto refused = indexed_mesh(surface, 9, progress);
  REQUIRE(std::holds_alternative<qnv::EncodeError>(refused));
  CHECK(std::get<qnv::EncodeError>(refused).message.find("--memory") != std::string::npos);
}
