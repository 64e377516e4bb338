#include "app/insitu/parameters.h"

#include <catch2/catch.hpp>

#include <cmath>

namespace gs::app::insitu {
namespace parameters_test {

gs_insitu_parameter parameter_of(const char* name, double minimum, double maximum, double value, bool integer = false) {
  gs_insitu_parameter parameter{};
  parameter.size = sizeof parameter;
  parameter.name = name;
  parameter.minimum = minimum;
  parameter.maximum = maximum;
  parameter.value = value;
  parameter.integer = integer ? 1 : 0;
  return parameter;
}

TEST_CASE("parameters: a change holds from the next step on") {
  Parameters all;
  REQUIRE_FALSE(all.add(parameter_of("feed", 0, 1, 0.25)));
  REQUIRE_FALSE(all.add(parameter_of("count", 1, 10, 2, true)));
  CHECK_FALSE(all.set_wanted("feed=0.5&count=7"));
  CHECK(all.value("feed") == 0.25);
  CHECK(all.take_wanted() == std::vector<double>{0.5, 7});
  CHECK(all.value("feed") == 0.5);
  CHECK(all.value("count") == 7);
  CHECK_FALSE(all.value("other"));
  all.set({0.75, 3});
  CHECK(all.value("feed") == 0.75);
}

TEST_CASE("parameters: a wrong change is refused as a whole") {
  Parameters all;
  REQUIRE_FALSE(all.add(parameter_of("feed", 0, 1, 0.25)));
  REQUIRE_FALSE(all.add(parameter_of("count", 1, 10, 2, true)));
  all.set_fields({"U", "wind speed"}, "U");
  for (const char* query : {"feed=0.5&other=1", "feed=2", "feed=", "feed=nan", "feed=1e999", "feed=0.5x", "count=1.5",
                            "feed", "=1", "feed=%zz", "feed=%4", "field=V", "feed=0.5&count=99"}) {
    INFO(query);
    CHECK(all.set_wanted(query));
    CHECK(all.take_wanted() == std::vector<double>{0.25, 2});
    CHECK(all.field().empty());
  }
  CHECK(*all.set_wanted("feed=2") == "feed: the value is out of range; expected 0 to 1");
  CHECK_FALSE(all.set_wanted("field=wind%20speed"));
  CHECK(all.field() == "wind speed");
  CHECK_FALSE(all.set_wanted(""));
}

TEST_CASE("parameters: names and ranges are checked") {
  Parameters all;
  for (const char* name : {"", "a b", "field", "a-b", "\xc3\xa4"}) CHECK(all.add(parameter_of(name, 0, 1, 0)));
  CHECK(all.add(parameter_of("a", 1, 0, 0)));
  CHECK(all.add(parameter_of("a", 0, 1, 2)));
  CHECK(all.add(parameter_of("a", 0, INFINITY, 2)));
  REQUIRE_FALSE(all.add(parameter_of("a", 0, 1, 1)));
  CHECK(all.add(parameter_of("a", 0, 1, 1)));
  for (std::size_t i = 1; i < Parameters::kMaxParameters; ++i)
    REQUIRE_FALSE(all.add(parameter_of(("p" + std::to_string(i)).c_str(), 0, 1, 1)));
  CHECK(all.add(parameter_of("one_more", 0, 1, 1)));
}

}  // namespace parameters_test
}  // namespace gs::app::insitu
