// Tests of the requests of views for streams that are received as cells over UDP.
#include "tests/app/loading/fetch/cell_site.h"
#include "tests/geometries.h"

#include <catch2/catch.hpp>

using namespace gs;
using namespace gs::app;

TEST_CASE("requests regions by what views see of a stream") {
  const Box all{{-1, -1, -1}, {1, 1, 1}};
  std::array<qnv::LodView, 3> views;
  CHECK(regions_of({}, all).empty());
  CHECK(regions_of(views, all).empty());  // everything
  // The upper quarter of x, from both sides of a thin slice of y.
  views[1].planes = {{{1, 0, 0, -0.5f}, {0, 1, 0, 0.1f}, {0, -1, 0, 0.1f}}};
  views[2].planes[0] = {0, 0, 1, -5};  // empty
  const auto regions = regions_of(views, all);
  REQUIRE(regions.size() == 1);
  const auto part = [](std::uint16_t value) { return 2.0 * value / 65535 - 1; };
  const net::CellBox& box = regions[0].box;
  CHECK(part(box[0]) <= 0.5);
  CHECK(part(box[0]) > 0.5 - 0.5 / 7);  // at least six of seven parts are visible
  CHECK(part(box[3]) == Approx(1).margin(0.001));
  CHECK(part(box[1]) <= -0.1);
  CHECK(part(box[1]) > -0.1 - 0.2 / 6);
  CHECK(part(box[4]) >= 0.1);
  CHECK(part(box[4]) < 0.1 + 0.2 / 6);
  CHECK(box[2] == 0);
  CHECK(box[5] == 65535);
  // Equal views make one region, and the number of regions is limited.
  std::vector<qnv::LodView> many(20, views[1]);
  CHECK(regions_of(many, all).size() == 1);
  for (std::size_t i = 0; i < many.size(); ++i) many[i].planes[0].w = -0.5f - 0.02f * static_cast<float>(i);
  CHECK(regions_of(many, all).size() == net::kMaxRegions);
  // A flat box, and invalid numbers.
  const Box flat{{0, 0, 0}, {1, 0, 1}};
  CHECK(regions_of(std::span(views).subspan(1, 1), flat).size() == 1);
  views[1].planes[0] = glm::vec4(std::numeric_limits<float>::quiet_NaN());
  CHECK(regions_of(views, all).size() <= 1);
}

TEST_CASE("shows the base in a window at once, and requests the next parts by view") {
  CellSite site;
  site.options.rate = 8'000'000;
  site.start();
  LoadOptions options;
  options.by_view = true;
  options.timeout_seconds = 120;
  WorldLoading loading(site.url("packed.qnv"), options);
  while (!loading.done()) (void)loading.step(kCellWait);
  CHECK(loading.streaming());
  CHECK(loading.state().received < 200'000);
  const LoadedWorld world = loading.take();
  REQUIRE(world.feeds.size() == 1);
  StreamFeed& feed = *world.feeds.front();
  (void)feed.apply();
  auto& levels = *content_of<qnv::OctreeSplats>(*world.geometries.begin()->second).stream;
  REQUIRE(levels.statistics().clusters > 0);
  // A close view of the right side.
  qnv::LodView view;
  view.eye = {3, 0, 0};
  view.pixels = 1e5f;
  view.planes[0] = {1, 0, 0, -0.8f};
  (void)levels.cut(view);
  feed.ask();
  const auto discs = [&levels](const qnv::LodView& from) {
    std::size_t sum = 0;
    for (const qnv::Piece& piece : levels.cut(from)) sum += piece.count;
    return sum;
  };
  qnv::LodView opposite = view;
  opposite.eye = {-3, 0, 0};
  opposite.planes[0] = {-1, 0, 0, -0.8f};
  opposite.viewport = 1;
  const std::size_t before = discs(view);
  bool preferred = false;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(100);
  while (!preferred && std::chrono::steady_clock::now() < deadline) {
    (void)loading.step(kCellWait);
    if (feed.apply()) preferred = discs(view) > 4 * before && discs(view) > 2 * discs(opposite);
  }
  CHECK(preferred);
  // With a smaller weight, the stream requests a smaller share of the rate.
  feed.set_weight(0.25);
  while (loading.cells().granted > 2'200'000 && std::chrono::steady_clock::now() < deadline)
    (void)loading.step(kCellWait);
  CHECK(loading.cells().granted <= 2'200'000);
  feed.set_weight(1);
  // A complete stream stops requests.
  while (loading.streaming() && std::chrono::steady_clock::now() < deadline) {
    (void)loading.step(kCellWait);
    (void)feed.apply();
  }
  CHECK_FALSE(loading.streaming());
  CHECK(levels.count() == geometry_of_world(load_world(site.folder.path("packed.qnv"))).size());
}
