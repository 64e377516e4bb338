#include "app/view/values/slices.h"

#include "app/view/values/volume_display.h"

#include <catch2/catch.hpp>

namespace gs::app::slices_test {

TEST_CASE("offers windows of computed tomography for Hounsfield units only") {
  const auto units = window_presets({-1024, 3071}, "");
  REQUIRE(units.size() == 4);
  CHECK(units[0].window == std::pair(-160.0f, 240.0f));
  CHECK(units[2].window == std::pair(-1350.0f, 150.0f));
  CHECK(window_presets({0, 3000}, "")[0].window == std::pair(840.0f, 1240.0f));
  CHECK(window_presets({0, 100}, "HU")[0].window == units[0].window);
  CHECK(window_presets({0, 255}, "").empty());
  CHECK(window_presets({-1, 1}, "K").empty());
}

TEST_CASE("reads shares of voxels as fractions and percentages") {
  CHECK(read_share("0.2") == 0.2f);
  CHECK(read_share("20%") == 0.2f);
  CHECK(read_share("0.5%") == 0.005f);
  for (const char* text : {"", "%", "0", "0.6", "51%", "nan", "1e9", "0.2x", "-0.1"}) CHECK_FALSE(read_share(text));
}

TEST_CASE("names the modes of volumes in options") {
  for (const VolumeModeRow& row : volume_modes()) {
    CHECK(find_volume_mode(row.name) == &row);
    CHECK(&volume_modes()[static_cast<std::size_t>(row.mode)] == &row);
  }
  CHECK_FALSE(find_volume_mode("mip"));
}

}  // namespace gs::app::slices_test
