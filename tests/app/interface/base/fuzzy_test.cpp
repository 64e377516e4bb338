#include "app/interface/base/fuzzy.h"

#include <catch2/catch.hpp>

namespace gs::app::fuzzy_test {

TEST_CASE("finds a name by a part, with a better score at the beginning of a word") {
  REQUIRE(fuzzy_score("Full screen", "screen"));
  CHECK(*fuzzy_score("Full screen", "full") > *fuzzy_score("Full screen", "screen"));
  CHECK(*fuzzy_score("Full screen", "screen") > *fuzzy_score("Full screen", "creen"));
  CHECK(*fuzzy_score("Full screen", "creen") > *fuzzy_score("Full screen", "fs"));
  CHECK(fuzzy_score("Full screen", "SCR FULL"));  // words in any order, letters of any case
  CHECK_FALSE(fuzzy_score("Full screen", "fullx"));
  CHECK_FALSE(fuzzy_score("Full screen", "full x"));
  CHECK(fuzzy_score("Full screen", "") == 0);
  CHECK(fuzzy_score("", ""));
  CHECK_FALSE(fuzzy_score("", "a"));
}

}  // namespace gs::app::fuzzy_test
