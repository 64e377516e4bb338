#include "app/view/viewports.h"

#include "tests/app/window_events.h"

#include <catch2/catch.hpp>

#include <numeric>

namespace {

using namespace gs::app;

std::vector<Viewport> beside() { return {{0, 0, 100, 100}, {100, 0, 100, 100}}; }

}  // namespace

TEST_CASE("keeps a drag in the viewport where it began") {
  const auto places = beside();
  const glm::vec2 left(50, 50), right(150, 50), outside(-20, 50);
  PointerRouter router;
  CHECK(router.route(event(EventKind::pointer, left), places) == 0u);
  CHECK(router.route(event(EventKind::pointer, right), places) == 1u);
  CHECK(router.route(event(EventKind::button_down, left), places) == 0u);
  CHECK(router.route(event(EventKind::pointer, right), places) == 0u);
  CHECK(router.route(event(EventKind::pointer, outside), places) == 0u);
  // During a drag too, the wheel goes to the viewport under the pointer.
  CHECK(router.route(event(EventKind::wheel, right), places) == 1u);
  // A second button joins the drag. The drag lasts until both buttons are released.
  CHECK(router.route(event(EventKind::button_down, right, MouseButton::right), places) == 0u);
  CHECK(router.route(event(EventKind::button_up, right), places) == 0u);
  CHECK(router.route(event(EventKind::pointer, right), places) == 0u);
  CHECK(router.route(event(EventKind::button_up, right, MouseButton::right), places) == 0u);
  CHECK(router.route(event(EventKind::pointer, right), places) == 1u);
  CHECK(router.route(event(EventKind::button_down, right), places) == 1u);
  router.release();
  CHECK(router.route(event(EventKind::pointer, left), places) == 0u);
}

TEST_CASE("assigns events outside all viewports to none") {
  const auto places = beside();
  PointerRouter router;
  CHECK_FALSE(router.route(event(EventKind::button_down, {300, 50}), places));
  CHECK(router.route(event(EventKind::pointer, {50, 50}), places) == 0u);  // no drag began there
  CHECK_FALSE(router.route(event(EventKind::key_down, {50, 50}), places));
  CHECK_FALSE(router.route(event(EventKind::focus_lost, {50, 50}), places));
  CHECK(router.route(event(EventKind::drop, {150, 50}), places) == 1u);
  // The button was pressed in a panel, and is released over a viewport.
  CHECK(router.route(event(EventKind::button_up, {150, 50}), places) == 1u);
  CHECK(router.route(event(EventKind::pointer, {50, 50}), places) == 0u);
  // A closed viewport has no pointer.
  CHECK(router.route(event(EventKind::button_down, {150, 50}), places) == 1u);
  CHECK(router.route(event(EventKind::pointer, {150, 50}), std::span(places).first(1)) == std::nullopt);
}

TEST_CASE("divides a budget by size") {
  const auto share = [](std::size_t total, std::vector<std::size_t> weights) { return shares_of(total, weights); };
  CHECK(share(2'000'000, {300}) == std::vector<std::size_t>{2'000'000});
  CHECK(share(2'000'000, {100, 300}) == std::vector<std::size_t>{500'000, 1'500'000});
  CHECK(share(1000, {0, 100, 0, 100}) == std::vector<std::size_t>{0, 500, 0, 500});
  CHECK(share(1000, {0, 0}) == std::vector<std::size_t>{0, 0});
  CHECK(share(1000, {}).empty());
  // No share is 0, because 0 would mean unlimited.
  CHECK(share(3, {1, 1'000'000}) == std::vector<std::size_t>{1, 2});
  CHECK(share(0, {5}) == std::vector<std::size_t>{1});
  const std::size_t most = std::numeric_limits<std::size_t>::max();
  const auto huge = share(most / 2, {most, most});
  CHECK(huge[0] == huge[1]);
  CHECK(huge[0] <= most / 2);
  const auto odd = share(1'000'003, {7, 11, 13});
  CHECK(std::accumulate(odd.begin(), odd.end(), std::size_t{0}) <= 1'000'003);
  CHECK(std::accumulate(odd.begin(), odd.end(), std::size_t{0}) > 1'000'000);
}

TEST_CASE("draws frames as long as they improve") {
  Refinement refinement;
  CHECK_FALSE(refinement.wanted());
  refinement.note(true, 100, true);
  CHECK(refinement.wanted());
  for (std::size_t discs = 200; discs < 100'000; discs += 100) refinement.note(true, discs, false);
  CHECK(refinement.wanted());
  refinement.note(false, 100'000, false);
  CHECK_FALSE(refinement.wanted());
  // The window rests if every picture still reports that a better one will follow.
  for (int i = 0; i <= Refinement::kMaxFramesAlike; ++i) refinement.note(true, 5, false);
  CHECK_FALSE(refinement.wanted());
  refinement.note(true, 5, false);
  CHECK_FALSE(refinement.wanted());
  refinement.note(true, 5, true);  // the view has changed
  CHECK(refinement.wanted());
}
