#include "app/interface/dock/dock.h"

#include <catch2/catch.hpp>

#include <limits>
#include <vector>

namespace gs::app::dock_test {
namespace {

constexpr DockRectangle kWhole{0, 40, 1280, 760};
constexpr float kDivider = Dock::kDivider;

Dock three_sides() { return Dock({DockSide::left, DockSide::right, DockSide::bottom, DockSide::bottom}); }

const DockLayout::Area& area_at(const DockLayout& layout, DockSide side) {
  const auto& area = layout.areas[static_cast<std::size_t>(side)];
  REQUIRE(area);
  return *area;
}

bool overlap(const DockRectangle& a, const DockRectangle& b) {
  return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height && b.top < a.top + a.height;
}

}  // namespace

TEST_CASE("gives the picture the whole window without open panels") {
  const DockLayout layout = three_sides().lay_out(kWhole, 1);
  for (const auto& area : layout.areas) CHECK_FALSE(area);
  CHECK(layout.picture.left == 0);
  CHECK(layout.picture.top == 40);
  CHECK(layout.picture.width == 1280);
  CHECK(layout.picture.height == 760);
}

TEST_CASE("docks panels beside the picture, never over it, at any window size") {
  Dock dock = three_sides();
  for (const std::size_t panel : {0, 1, 2}) dock.open(panel);
  dock.set_size(DockSide::left, 200);
  dock.set_size(DockSide::right, 300);
  dock.set_size(DockSide::bottom, 150);
  const DockLayout roomy = dock.lay_out(kWhole, 1);
  CHECK(area_at(roomy, DockSide::left).place.width == 200);
  CHECK(area_at(roomy, DockSide::right).place.width == 300);
  CHECK(area_at(roomy, DockSide::bottom).place.height == 150);
  CHECK(roomy.picture.left == 200 + kDivider);
  CHECK(roomy.picture.width == 1280 - 500 - 2 * kDivider);
  CHECK(roomy.picture.height == 760 - 150 - kDivider);
  for (const float scale : {0.5f, 1.0f, 2.0f})
    for (const DockRectangle& whole :
         {kWhole, DockRectangle{0, 60, 800, 440}, DockRectangle{0, 60, 320, 180}, DockRectangle{0, 60, 10, 10}}) {
      const DockLayout layout = dock.lay_out(whole, scale);
      CHECK(layout.picture.width >= 1);
      CHECK(layout.picture.height >= 1);
      std::vector<DockRectangle> all{layout.picture};
      for (const auto& area : layout.areas) {
        REQUIRE(area);
        CHECK(area->place.width >= 0);
        CHECK(area->place.height >= 0);
        all.push_back(area->place);
        all.push_back(area->divider);
      }
      for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) CHECK_FALSE(overlap(all[i], all[j]));
    }
  // The picture keeps its minimum size while the window is large enough.
  const DockLayout tight = dock.lay_out({0, 60, 500, 440}, 1);
  CHECK(tight.picture.width >= Dock::kMinPicture);
  CHECK(tight.picture.height >= Dock::kMinHeight);
}

TEST_CASE("brings the neighbour of a closed panel to the front") {
  Dock dock({DockSide::bottom, DockSide::bottom, DockSide::bottom});
  for (const std::size_t panel : {0, 1, 2}) dock.open(panel);
  CHECK(dock.is_front(2));
  dock.open(1);  // already open: comes to the front
  CHECK(dock.is_front(1));
  CHECK(dock.open_at(DockSide::bottom) == std::vector<std::size_t>{0, 1, 2});
  dock.close(1);
  CHECK(dock.is_front(2));
  dock.close(2);
  CHECK(dock.is_front(0));
  dock.close(0);
  CHECK_FALSE(dock.front_at(DockSide::bottom));
}

TEST_CASE("opens a panel by its key, brings it to the front, then closes it") {
  Dock dock({DockSide::bottom, DockSide::bottom});
  dock.toggle(0);
  dock.toggle(1);
  CHECK(dock.is_front(1));
  dock.toggle(0);
  CHECK(dock.is_front(0));
  dock.toggle(0);
  CHECK_FALSE(dock.is_open(0));
  CHECK(dock.is_front(1));
}

TEST_CASE("moves a panel to another side unchanged") {
  Dock dock({DockSide::left, DockSide::right});
  dock.open(0);
  dock.move(0, DockSide::right);
  CHECK(dock.is_front(0));
  CHECK(dock.open_at(DockSide::left).empty());
  dock.move(1, DockSide::bottom);
  CHECK_FALSE(dock.is_open(1));
  CHECK(dock.side_of(1) == DockSide::bottom);
}

TEST_CASE("keeps the size of an area after a divider was dragged") {
  Dock dock = three_sides();
  for (const std::size_t panel : {0, 1, 2}) dock.open(panel);
  const auto middle = [&](DockSide side) {
    const DockLayout layout = dock.lay_out(kWhole, 1);
    const DockRectangle& line = area_at(layout, side).divider;
    return side == DockSide::bottom ? line.top + line.height / 2 : line.left + line.width / 2;
  };
  dock.set_size(DockSide::left, Dock::size_for(DockSide::left, 301.5f, kWhole, 1));
  dock.set_size(DockSide::right, Dock::size_for(DockSide::right, 900.5f, kWhole, 1));
  dock.set_size(DockSide::bottom, Dock::size_for(DockSide::bottom, 500.5f, kWhole, 1));
  CHECK(middle(DockSide::left) == Approx(301.5f).margin(1));
  CHECK(middle(DockSide::right) == Approx(900.5f).margin(1));
  CHECK(middle(DockSide::bottom) == Approx(500.5f).margin(1));
  dock.set_size(DockSide::left, -50);
  CHECK(dock.size(DockSide::left) == Dock::kMinArea);
  dock.set_size(DockSide::left, std::numeric_limits<float>::quiet_NaN());
  CHECK(dock.size(DockSide::left) == Dock::kMinArea);
}

TEST_CASE("ignores numbers that belong to no panel") {
  Dock dock({DockSide::left});
  dock.open(7);
  dock.toggle(7);
  dock.close(7);
  dock.move(7, DockSide::right);
  CHECK_FALSE(dock.is_open(7));
  CHECK(dock.open_at(DockSide::left).empty());
}

}  // namespace gs::app::dock_test
