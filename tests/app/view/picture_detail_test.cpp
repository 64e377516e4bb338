#include "app/view/picture_detail.h"

#include <catch2/catch.hpp>

#include <functional>

namespace gs::app::picture_detail_test {
namespace {

/// Draws `pictures` changing pictures, each of which takes `seconds_of(level)`.
void draw(PictureDetail& detail, int pictures, const std::function<double(std::size_t)>& seconds_of) {
  for (int i = 0; i < pictures; ++i) detail.note(detail.level(true), false, seconds_of(detail.level(true)));
}

/// Returns the times of a scene that takes `seconds` with one sample at full resolution, and no time beside its pixels.
std::function<double(std::size_t)> pixels(double seconds) {
  return [seconds](std::size_t level) {
    const PictureQuality& quality = PictureDetail::kQualities[level];
    return seconds * (quality.one_sample ? 1 : 3) / (double{quality.coarseness} * double{quality.coarseness});
  };
}

}  // namespace

TEST_CASE("orders the qualities of pictures from fine to coarse") {
  CHECK(PictureDetail::kQualities[0] == PictureQuality{false, 1});
  CHECK(PictureDetail::splat_error(0) == 1);
  CHECK(PictureDetail::splat_error(1) > 10);
  for (std::size_t i = 1; i < PictureDetail::kQualities.size(); ++i) {
    CHECK(PictureDetail::kQualities[i].one_sample);
    CHECK(PictureDetail::kQualities[i].coarseness >= PictureDetail::kQualities[i - 1].coarseness);
  }
}

TEST_CASE("draws changing pictures with full quality if they are in time, and all pictures at rest") {
  PictureDetail detail;
  draw(detail, 50, pixels(0.02));
  CHECK(detail.level(true) == 0);
  draw(detail, 50, pixels(0.5));
  CHECK(PictureDetail::kQualities[detail.level(true)] == PictureQuality{true, 2});
  CHECK(detail.level(false) == 0);
}

TEST_CASE("omits anti-aliasing before resolution, and loses no more resolution than needed") {
  PictureDetail detail;
  draw(detail, 50, pixels(0.05));
  CHECK(detail.level(true) == 1);
  PictureDetail slower;
  draw(slower, 50, pixels(0.09));
  CHECK(PictureDetail::kQualities[slower.level(true)] == PictureQuality{true, 1.33f});
}

TEST_CASE("lowers the quality at once after one very late picture, but not after one slightly late picture") {
  PictureDetail detail;
  detail.note(0, false, 1.1 * PictureDetail::kGoal);
  CHECK(detail.level(true) == 0);
  detail.note(0, false, 0.01);
  detail.note(0, false, 1);
  CHECK(detail.level(true) > 0);
}

TEST_CASE("raises the quality again, but does not alternate between two levels") {
  PictureDetail detail;
  draw(detail, 50, pixels(0.5));
  draw(detail, 200, pixels(0.015));
  CHECK(detail.level(true) == 0);
  int changes = 0;
  for (int i = 0; i < 500; ++i) {
    const std::size_t before = detail.level(true);
    draw(detail, 1, pixels(0.055));
    changes += detail.level(true) != before ? 1 : 0;
  }
  CHECK(detail.level(true) == 1);
  CHECK(changes == 1);
}

TEST_CASE("keeps the quality if fewer pixels save no time, and tries again later") {
  PictureDetail detail;
  int coarse = 0;
  for (int i = 0; i < 1000; ++i) {
    draw(detail, 1, [](std::size_t) { return 0.15; });
    coarse += detail.level(true) > 0 ? 1 : 0;
  }
  CHECK(coarse > 0);
  CHECK(coarse < 50);
}

TEST_CASE("lowers the quality after pictures that the user's input cancelled") {
  PictureDetail detail;
  detail.note(0, true, 0.4);
  const std::size_t once = detail.level(true);
  CHECK(once > 0);
  detail.note(0, true, 0.4);  // full quality, after too short a rest
  CHECK(detail.level(true) == once);
  for (int i = 0; i < 5; ++i) detail.note(detail.level(true), true, 0.4);
  CHECK(detail.level(true) == PictureDetail::kQualities.size() - 1);
}

TEST_CASE("keeps the loading progress visible during slow pictures") {
  LoadingPace pace;
  CHECK(pace.go_on(10, 10.49));
  CHECK_FALSE(pace.go_on(10, 10.5));
  pace.note(true, 10, 10.6);
  CHECK_FALSE(pace.go_on(11, 11));  // the interface gets equal time
  pace.note(true, 11, 11);
  CHECK(pace.go_on(11.25, 12));
  CHECK_FALSE(pace.go_on(11.25, 12.25));
  for (double begin = 20; begin < 1000; begin += 50) pace.note(true, begin, begin + LoadingPace::kMax);
  CHECK(pace.go_on(2000, 2000 + LoadingPace::kMax - 0.1));
  CHECK_FALSE(pace.go_on(2000, 2000 + LoadingPace::kMax));
  pace.note(true, 2000, 2000.1);  // the next frame follows user input
  CHECK(pace.go_on(2001, 2003));
  pace.note(false, 2001, 2003);
  CHECK_FALSE(pace.go_on(2010, 2010.5));
}

}  // namespace gs::app::picture_detail_test
