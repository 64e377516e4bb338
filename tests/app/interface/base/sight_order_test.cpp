#include "app/interface/base/sight_order.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace gs::app::sight_order_test {

TEST_CASE("shows left-to-right text unchanged") {
  const SightOrder order = sight_order(U"abc");
  CHECK(order.characters == U"abc");
  CHECK(order.places == std::vector<std::size_t>{0, 1, 2});
  for (std::size_t i = 0; i <= 3; ++i) CHECK(order.caret(i) == i);
  CHECK(order.index_at(1, false) == 1);
  CHECK(order.index_at(1, true) == 2);
  CHECK(order.index_at(9, true) == 3);
  CHECK(sight_order(U"").caret(0) == 0);
  CHECK(sight_order(U"").index_at(0, true) == 0);
  CHECK_FALSE(has_right_to_left(U"abc"));
}

TEST_CASE("shows right-to-left text in visual order, with the caret beside the next letter") {
  const std::u32string text = U"ab \u05d0\u05d1\u05d2 12";  // in a line from left to right: ab 12 gimel bet alef
  REQUIRE(has_right_to_left(text));
  const SightOrder order = sight_order(text);
  CHECK(order.characters == U"ab 12 \u05d2\u05d1\u05d0");
  CHECK(order.places == std::vector<std::size_t>{0, 1, 2, 8, 7, 6, 5, 3, 4});
  CHECK(order.caret(3) == 9);  // right of alef
  CHECK(order.caret(4) == 8);  // between bet and alef
  CHECK(order.index_at(8, true) == 3);
  CHECK(order.index_at(8, false) == 4);
  CHECK(order.index_at(7, true) == 4);
  // Within a run, the caret moves to the pointed position.
  for (std::size_t place = 0; place < text.size(); ++place)
    for (const bool right : {false, true}) CHECK(order.index_at(place, right) <= text.size());
}

TEST_CASE("begins right-to-left lines on the right, and joins Arabic letters") {
  const SightOrder hebrew = sight_order(U"\u05d0\u05d1");
  CHECK(hebrew.characters == U"\u05d1\u05d0");
  CHECK(hebrew.caret(0) == 2);
  CHECK(hebrew.caret(2) == 0);
  const SightOrder arabic = sight_order(U"\u0644\u0627");  // lam and alef become one
  REQUIRE(arabic.characters.size() == 2);
  CHECK(std::count(arabic.characters.begin(), arabic.characters.end(), SightOrder::kNothing) == 1);
  CHECK(arabic.characters.find(U'\uFEFB') != std::u32string::npos);
}

TEST_CASE("shows lines of any length") {
  const std::u32string text(100'000, U'\u05d0');
  CHECK(sight_order(text).characters == text);
}

}  // namespace gs::app::sight_order_test
