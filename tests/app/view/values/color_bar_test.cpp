#include "app/view/values/color_bar.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace gs::app::color_bar_test {
namespace {

std::string labels(double least, double largest, std::size_t most) {
  std::string text;
  for (const Tick& tick : nice_ticks({least, largest}, most)) text += (text.empty() ? "" : " ") + tick.label;
  return text;
}

}  // namespace

TEST_CASE("places ticks at 1, 2 and 5 times powers of ten, as many as fit") {
  CHECK(labels(0, 255, 6) == "0 50 100 150 200 250");
  CHECK(labels(0, 255, 5) == "0 100 200");
  CHECK(labels(-1024, 3071, 10) == "-1000 -500 0 500 1000 1500 2000 2500 3000");
  CHECK(labels(0, 1, 6) == "0.0 0.2 0.4 0.6 0.8 1.0");
  CHECK(labels(-0.3, 0.3, 7) == "-0.3 -0.2 -0.1 0.0 0.1 0.2 0.3");
  CHECK(labels(0.0012, 0.0049, 5) == "0.002 0.003 0.004");
  CHECK(labels(3e9, 5e9, 3) == "3e+09 4e+09 5e+09");
  CHECK(labels(1e-8, 3e-8, 5).find("e-08") != std::string::npos);
}

TEST_CASE("places ticks in order within any range") {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  for (const auto& [least, largest] : {std::pair{0.0, 0.0},
                                       {1.0, -1.0},
                                       {nan, 1.0},
                                       {0.0, infinity},
                                       {-1e308, 1e308},
                                       {1e15, 1e15 + 1},
                                       {0.0, 5e-324},
                                       {-7.0, 1e-9}})
    for (const std::size_t most : {0u, 1u, 2u, 7u}) {
      const auto ticks = nice_ticks({least, largest}, most);
      REQUIRE_FALSE(ticks.empty());
      CHECK(ticks.size() <= std::max<std::size_t>(most, 2));
      for (std::size_t i = 0; i < ticks.size(); ++i) {
        CHECK(ticks[i].place >= 0);
        CHECK(ticks[i].place <= 1);
        if (i > 0) CHECK(ticks[i].place >= ticks[i - 1].place);
      }
    }
}

TEST_CASE("titles a bar by the file's description of its values") {
  qnv::Description volume;
  volume.value_range = {-10, 30};
  volume.metadata = {{"array", "temperature"}, {"sample units", "K"}};
  const ColorBar bar = color_bar_of(volume, {{0, {1, 2, 3}, 1}});
  CHECK(bar.title == "temperature (K)");
  CHECK(bar.range == std::pair<double, double>{-10, 30});
  CHECK(value_unit(volume) == "K");
  volume.metadata = {{"units", "Jy"}};
  CHECK(color_bar_of(volume, {}).title == "Jy");
  volume.metadata.clear();
  CHECK(color_bar_of(volume, {}).title.empty());
  CHECK(readable_value(12.5, "K") == "12.5 K");
  CHECK(readable_value(1234567) == "1.2346e+06");
}

}  // namespace gs::app::color_bar_test
