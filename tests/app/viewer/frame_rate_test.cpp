#include "app/viewer/frame_rate.h"

#include <catch2/catch.hpp>

namespace gs::app::frame_rate_test {

TEST_CASE("counts the frames of the last second") {
  FrameRate rate;
  CHECK(rate.a_second() == 0);
  rate.drawn(100, true);
  CHECK(rate.a_second() == 0);  // one picture has no rate
  for (int i = 1; i <= 100; ++i) rate.drawn(100 + i * 0.02, true);
  CHECK(rate.a_second() == Approx(50));
  // Two simultaneous frames do not raise the rate.
  rate.drawn(102.0001, true);
  CHECK(rate.a_second() == Approx(51).margin(0.5));
  // A long frame lowers the rate immediately. So do frames of over a second.
  rate.drawn(102.25, true);
  CHECK(rate.a_second() < 42);
  rate.drawn(105, true);
  CHECK(rate.a_second() == Approx(1 / 2.75));
  rate.drawn(109, true);
  CHECK(rate.a_second() == Approx(0.25));
}

TEST_CASE("reports no frame rate at rest, and starts again") {
  FrameRate rate;
  for (int i = 0; i < 10; ++i) rate.drawn(i * 0.1, true);
  rate.drawn(5, false);
  CHECK(rate.a_second() == 0);
  rate.drawn(5.1, true);
  CHECK(rate.a_second() == Approx(10));
  // The clock is set back.
  rate.drawn(3, true);
  CHECK(rate.a_second() == 0);
}

}  // namespace gs::app::frame_rate_test
