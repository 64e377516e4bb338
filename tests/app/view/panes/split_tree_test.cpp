#include "app/view/panes/split_tree.h"

#include <catch2/catch.hpp>

#include <string>
#include <utility>
#include <vector>

namespace {

using namespace gs::app;
using Panes_ = std::vector<std::size_t>;

const Viewport kWindow{0, 34, 1025, 735};

SplitTree split(const std::string& text) {
  auto read = read_split(text);
  INFO(text << ": " << (std::holds_alternative<std::string>(read) ? std::get<std::string>(read) : ""));
  REQUIRE(std::holds_alternative<SplitTree>(read));
  return std::get<SplitTree>(read);
}

std::string why_not(const std::string& text) {
  const auto read = read_split(text);
  REQUIRE(std::holds_alternative<std::string>(read));
  return std::get<std::string>(read);
}

void check_place(const Viewport& place, int left, int top, int width, int height) {
  CHECK(place.left == left);
  CHECK(place.top == top);
  CHECK(place.width == width);
  CHECK(place.height == height);
}

}  // namespace

TEST_CASE("opens several viewports for several files") {
  CHECK(layout_for(0) == ViewportLayout::one);
  CHECK(layout_for(1) == ViewportLayout::one);
  CHECK(layout_for(2) == ViewportLayout::two);
  CHECK(layout_for(3) == ViewportLayout::four);
  CHECK(layout_for(4) == ViewportLayout::four);
  CHECK(layout_for(100) == ViewportLayout::four);
  CHECK(next_layout(ViewportLayout::one) == ViewportLayout::two);
  CHECK(next_layout(ViewportLayout::two) == ViewportLayout::four);
  CHECK(next_layout(ViewportLayout::four) == ViewportLayout::one);
}

TEST_CASE("keeps the active viewport visible in every layout") {
  CHECK(panes_in_sight(split_of(ViewportLayout::one, 0)) == Panes_{0});
  CHECK(panes_in_sight(split_of(ViewportLayout::one, 3)) == Panes_{3});
  CHECK(panes_in_sight(split_of(ViewportLayout::two, 1)) == Panes_{0, 1});
  CHECK(panes_in_sight(split_of(ViewportLayout::two, 2)) == Panes_{2, 3});
  CHECK(panes_in_sight(split_of(ViewportLayout::four, 2)) == Panes_{0, 1, 2, 3});
  CHECK(panes_in_sight(split_of(ViewportLayout::four, 5)) == Panes_{4, 5, 6, 7});
  CHECK(panes_in_sight(split_of(ViewportLayout::one, 99)) == Panes_{kMaxViewports - 1});
  for (const ViewportLayout layout : {ViewportLayout::one, ViewportLayout::two, ViewportLayout::four})
    CHECK(layout_of(split_of(layout, 0)) == layout);
  CHECK_FALSE(layout_of(split("1|2|3")));
  CHECK(layout_of(split("1|2|3!2")) == ViewportLayout::one);
}

TEST_CASE("covers the area by layouts without gaps") {
  auto places = arrange(split_of(ViewportLayout::one, 0), kWindow);
  REQUIRE(places.size() == 1);
  check_place(places[0], 0, 34, 1025, 735);

  places = arrange(split_of(ViewportLayout::two, 0), kWindow);
  REQUIRE(places.size() == 2);
  check_place(places[0], 0, 34, 512, 735);
  check_place(places[1], 512, 34, 513, 735);

  places = arrange(split_of(ViewportLayout::two, 0), {10, 20, 300, 601});  // taller than wide
  REQUIRE(places.size() == 2);
  check_place(places[0], 10, 20, 300, 300);
  check_place(places[1], 10, 320, 300, 301);

  places = arrange(split_of(ViewportLayout::four, 0), kWindow);
  REQUIRE(places.size() == 4);
  check_place(places[0], 0, 34, 512, 367);
  check_place(places[1], 512, 34, 513, 367);
  check_place(places[2], 0, 401, 512, 368);
  check_place(places[3], 512, 401, 513, 368);

  for (const Viewport& place : arrange(split("1|(2/3)|4"), {0, 0, 1, 1})) {
    CHECK(place.width == 1);
    CHECK(place.height == 1);
  }
}

TEST_CASE("assigns every pixel of the area to one viewport of any split") {
  const Viewport area{3, 5, 7, 9};
  for (const char* text : {"1", "1+2", "(1|2)/(3|4)", "1|(2/3)", "1:3|2", "(1/2/3):2|4:0.5|5"}) {
    CAPTURE(text);
    const auto places = arrange(split(text), area);
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 12; ++x) {
        const glm::vec2 pointer(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        int owners = 0;
        for (const Viewport& place : places) owners += place.contains(pointer) ? 1 : 0;
        if (owners != (area.contains(pointer) ? 1 : 0)) FAIL("pixel " << x << ", " << y << ": " << owners);
        if (viewport_at(places, pointer).has_value() != (owners == 1)) FAIL("pixel " << x << ", " << y);
      }
  }
  const auto places = arrange(split_of(ViewportLayout::four, 0), {0, 0, 100, 100});
  CHECK(viewport_at(places, {0, 0}) == 0u);
  CHECK(viewport_at(places, {49.9f, 50}) == 2u);
  CHECK(viewport_at(places, {50, 49.9f}) == 1u);
  CHECK(viewport_at(places, {99, 99}) == 3u);
  CHECK_FALSE(viewport_at(places, {100, 50}));
  CHECK_FALSE(viewport_at(places, {-1, 50}));
}

TEST_CASE("splits a viewport to the right and below repeatedly") {
  SplitTree tree = split("1");
  tree = split_pane(tree, 0, SplitAxis::columns, 1);
  CHECK(split_text(tree) == "1|2");
  tree = split_pane(tree, 1, SplitAxis::rows, 2);
  CHECK(split_text(tree) == "1|(2/3)");
  // Splitting along the same axis puts the halves beside their siblings.
  tree = split_pane(tree, 0, SplitAxis::columns, 3);
  CHECK(panes_of(tree) == Panes_{0, 3, 1, 2});
  CHECK(tree.root.parts.size() == 3);
  const auto places = arrange(tree, {0, 0, 400, 400});
  check_place(places[0], 0, 0, 100, 400);
  check_place(places[1], 100, 0, 100, 400);
  check_place(places[2], 200, 0, 200, 200);
  check_place(places[3], 200, 200, 200, 200);
  CHECK(split_pane(tree, 0, SplitAxis::rows, 2) == tree);  // an existing viewport
  CHECK(split_pane(tree, 9, SplitAxis::rows, 8) == tree);  // a missing viewport
  CHECK_FALSE(split_pane(with_maximised(tree, 2), 2, SplitAxis::rows, 7).maximised);
}

TEST_CASE("makes columns or rows of a split along the longer side") {
  CHECK(split_text(resolved(split("1+2"), {0, 0, 200, 100})) == "1|2");
  CHECK(split_text(resolved(split("1+2"), {0, 0, 100, 200})) == "1/2");
  CHECK(split_text(split_pane(resolved(split("1+2"), {0, 0, 200, 100}), 1, SplitAxis::columns, 2)) == "1:2|2|3");
  CHECK(split_text(resolved(split("(1+2)|3"), {0, 0, 800, 100})) == "1|2|3:2");
}

TEST_CASE("gives the area of a closed viewport to its neighbour") {
  CHECK(split_text(without_pane(split("1|2"), 0)) == "2");
  CHECK(split_text(without_pane(split("1|2"), 1)) == "1");
  CHECK(split_text(without_pane(split("1|(2/3)"), 1)) == "1|3");
  CHECK(split_text(without_pane(split("1|(2/3)"), 0)) == "2/3");
  CHECK(split_text(without_pane(split("1|2|3"), 1)) == "1:2|3");
  CHECK(split_text(without_pane(split("1|2|3"), 0)) == "2:2|3");
  // The rest of a split joins the outer split along the same axis.
  const SplitTree tree = without_pane(split("1|(2/(3|4))"), 1);
  CHECK(split_text(tree) == "1:2|3|4");
  check_place(arrange(tree, {0, 0, 400, 100})[2], 300, 0, 100, 100);
  CHECK(without_pane(split("1"), 0) == split("1"));  // the last one stays
  CHECK(without_pane(split("1|2"), 7) == split("1|2"));
  CHECK_FALSE(without_pane(split("1|2|3!2"), 1).maximised);
  CHECK(without_pane(split("1|2|3!2"), 0).maximised == 1u);
}

TEST_CASE("restores the former viewport when a split is closed") {
  for (const char* text : {"1", "1|2", "1/2", "1|(2/3)", "(1|2)/(3|4)"}) {
    const SplitTree before = split(text);
    for (const std::size_t pane : panes_of(before))
      for (const SplitAxis axis : {SplitAxis::columns, SplitAxis::rows}) {
        const SplitTree more = split_pane(before, pane, axis, 8);
        CHECK(panes_of(more).size() == panes_of(before).size() + 1);
        CHECK(without_pane(more, 8) == before);
      }
  }
}

TEST_CASE("places dividers between viewports, and drags them within the minimum sizes") {
  const Viewport area{10, 20, 400, 200};
  const SplitTree tree = split("1|(2/3)|4");
  const auto dividers = dividers_of(tree, area);
  REQUIRE(dividers.size() == 3);
  CHECK(dividers[0].upright);
  check_place(dividers[0].place, 143, 20, 0, 200);
  check_place(dividers[1].place, 276, 20, 0, 200);
  CHECK_FALSE(dividers[2].upright);
  check_place(dividers[2].place, 143, 120, 133, 0);
  const auto column_of = [&](const SplitTree& one, std::size_t pane) { return arrange(one, area)[pane].left; };
  for (int place = 60; place < 226; ++place) {
    const SplitTree moved = with_divider_at(tree, dividers[0], area, place, 50);
    if (column_of(moved, 1) != place) FAIL("to " << place << ": " << column_of(moved, 1));
    if (column_of(moved, 3) != 276) FAIL("the other divider has moved to " << column_of(moved, 3));
  }
  CHECK(column_of(with_divider_at(tree, dividers[0], area, -500, 50), 1) == 60);
  CHECK(column_of(with_divider_at(tree, dividers[0], area, 5000, 50), 1) == 226);
  CHECK(arrange(with_divider_at(tree, dividers[2], area, 90, 50), area)[2].top == 90);
  CHECK(arrange(with_divider_at(tree, dividers[2], area, 30, 50), area)[2].top == 70);
  // Without enough space, the divider is in the middle.
  CHECK(arrange(with_divider_at(tree, dividers[2], area, 30, 150), area)[2].top == 120);
  // Two viewports on top of each other need the width of one viewport. Two viewports side by side need twice that
  // width.
  const SplitTree nested = split("(1/2)|((3|4)/5)");
  CHECK(arrange(with_divider_at(nested, dividers_of(nested, area)[0], area, 5000, 50), area)[2].left == 310);
  CHECK(dividers_of(split("1|2!1"), area).empty());
  CHECK(dividers_of(split("1"), area).empty());
  // A divider of another tree has no effect.
  CHECK(with_divider_at(split("1"), dividers[1], area, 50, 50) == split("1"));
  CHECK(with_divider_at(split("1|2"), dividers[2], area, 50, 50) == split("1|2"));
  (void)with_divider_at(tree, dividers[0], {0, 0, 1, 1}, 0, 50);
}

TEST_CASE("swaps, maximises, equalises and cycles viewports") {
  const SplitTree tree = split("1:3|(2/3)");
  CHECK(panes_of(with_swapped(tree, 0, 2)) == Panes_{2, 1, 0});
  CHECK(with_swapped(with_swapped(tree, 0, 2), 2, 0) == tree);
  CHECK(with_swapped(tree, 0, 7) == tree);
  CHECK(panes_of(with_replaced(tree, 1, 5)) == Panes_{0, 5, 2});
  CHECK(with_replaced(tree, 1, 2) == tree);
  CHECK(with_replaced(split("1|2!2"), 1, 4) == split("1|5!5"));

  const SplitTree large = with_maximised(tree, 2);
  CHECK(panes_in_sight(large) == Panes_{2});
  CHECK(panes_of(large) == Panes_{0, 1, 2});
  check_place(arrange(large, kWindow).at(0), 0, 34, 1025, 735);
  CHECK(with_maximised(large, 2) == tree);
  CHECK(panes_in_sight(with_maximised(large, 0)) == Panes_{0});
  CHECK(with_maximised(tree, 7) == tree);
  CHECK_FALSE(with_maximised(split("1"), 0).maximised);  // already so

  CHECK(split_text(evened_out(split("1:3|(2/3:9):2"))) == "1|(2/3)");
  CHECK(next_pane(tree, 0, 1) == 1);
  CHECK(next_pane(tree, 2, 1) == 0);
  CHECK(next_pane(tree, 0, -1) == 2);
  CHECK(next_pane(tree, 9, 1) == 0);
  CHECK(has_pane(tree, 2));
  CHECK_FALSE(has_pane(tree, 3));
}

TEST_CASE("restores splits from their text") {
  for (const char* text :
       {"1", "12", "1|2", "2/1", "1:2|(2/3)", "1:1.25|2|3:40", "1+2", "1|2|3", "(1|2)/(3|4)", "1|(2/(3|4))", "1|2!2"})
    CHECK(split_text(split(text)) == text);
  CHECK(split_text(split("1:1|2:1")) == "1|2");
  CHECK(split_text(split("1:3|2:2")) == "1:1.5|2");
  const SplitTree tree = split("1:2|(2/3)");
  const auto places = arrange(tree, {0, 0, 300, 100});
  check_place(places[0], 0, 0, 200, 100);
  check_place(places[1], 200, 0, 100, 50);
  CHECK(split_text(split(split_text(tree))) == split_text(tree));
  CHECK(split("(1)") == split("1"));
  CHECK(split("1:5") == split("1"));
  CHECK_FALSE(split("1!1").maximised);
}

TEST_CASE("rejects invalid splits with a reason") {
  const std::pair<const char*, const char*> reasons[] = {
      {"", "expected viewport numbers from 1 to 12"},
      {"0", "expected viewport numbers from 1 to 12"},
      {"13", "expected viewport numbers from 1 to 12"},
      {"-1", "expected viewport numbers from 1 to 12"},
      {"1|", "expected viewport numbers from 1 to 12"},
      {"99999999999999999999999", "expected viewport numbers from 1 to 12"},
      {"1|1", "viewport 1 is given twice"},
      {"1|2/3", "expected brackets around a mix of '|', '/' and '+'"},
      {"(1|2", "a bracket is not closed; expected ')'"},
      {"1|2)", "expected the end before ')'"},
      {"1 2", "expected the end before ' 2'"},
      {"1:0|2", "expected a number from 0.001 to 1000 after ':'"},
      {"1:nan|2", "expected a number from 0.001 to 1000 after ':'"},
      {"1:|2", "expected a number from 0.001 to 1000 after ':'"},
      {"1|2!3", "expected the number of one of the viewports after '!'"},
  };
  for (const auto& [text, reason] : reasons) CHECK(why_not(text) == reason);
  CHECK(why_not(std::string(100'000, '(')) == "too many nested brackets");
}
