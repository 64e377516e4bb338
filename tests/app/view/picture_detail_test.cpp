#include "app/view/picture_detail.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstddef>
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

/// Scene of Gaussians, with seconds per picture and seconds per drawn Gaussian. Coarser Gaussians are optional.
struct GaussianScene {
  double picture, each;
  std::size_t all;
  bool has_levels = true;

  [[nodiscard]] std::size_t drawn(const PictureDetail& detail, std::size_t level) const {
    return level == 0 || !has_levels ? all : std::min(all, detail.most_gaussians(level));
  }
  [[nodiscard]] double seconds(const PictureDetail& detail, std::size_t level) const {
    const double side = double{PictureDetail::kQualities[level].coarseness};
    return picture / (side * side) + each * static_cast<double>(drawn(detail, level));
  }
  /// Draws one changing picture. Returns its time.
  double draw(PictureDetail& detail) const {
    const std::size_t level = detail.level(true);
    const double time = seconds(detail, level);
    detail.note(level, false, time, drawn(detail, level));
    return time;
  }
};

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

TEST_CASE("draws so many Gaussians that changing pictures are in time, on fast and slow machines") {
  for (const double each : {30e-9, 120e-9, 300e-9}) {
    PictureDetail detail;
    const GaussianScene scene{0.015, each, 3'000'000};
    CHECK(detail.most_gaussians(0) == 0);
    int late = 0, changes = 0;
    for (int i = 0; i < 60; ++i) scene.draw(detail);
    for (int i = 0; i < 300; ++i) {
      const std::size_t most = detail.most_gaussians(1);
      late += scene.draw(detail) > PictureDetail::kGoal ? 1 : 0;
      changes += detail.most_gaussians(1) != most ? 1 : 0;
    }
    INFO(each << " s each: " << detail.most_gaussians(1) << " Gaussians, level " << detail.level(true));
    CHECK(late < 15);
    CHECK(changes < 10);
    CHECK(detail.level(true) == 1);
    CHECK(scene.seconds(detail, 1) > 0.6 * PictureDetail::kGoal);
  }
}

TEST_CASE("keeps the number of Gaussians during fades, and reduces the resolution if there are no coarser ones") {
  PictureDetail detail;
  detail.note(0, false, 0.4, 1'000'000);
  REQUIRE(detail.level(true) > 0);
  const std::size_t level = detail.level(true), most = detail.most_gaussians(level);
  for (int i = 0; i < 5; ++i) detail.note(level, false, 0.2, 1'000'000);
  CHECK(detail.level(true) == level);
  CHECK(detail.most_gaussians(level) == most);
  // Until fewer Gaussians are drawn, the first pictures of a coarser level may be as slow as the pictures before.
  PictureDetail stays;
  for (int i = 0; i < 3; ++i) stays.note(0, false, 0.15, 2'000'000);
  REQUIRE(stays.level(true) == 1);
  for (int i = 0; i < 4; ++i) stays.note(1, false, 0.15, 300'000);
  CHECK(stays.level(true) == 1);
  CHECK(stays.most_gaussians(1) < 200'000);
  PictureDetail slow;
  const GaussianScene scene{0.02, 500e-9, 1'000'000, false};
  for (int i = 0; i < 100; ++i) scene.draw(slow);
  CHECK(slow.most_gaussians(1) == PictureDetail::kFirstGaussians);
  // The number of Gaussians never falls below the minimum.
  PictureDetail few;
  for (int i = 0; i < 100; ++i) GaussianScene{0.5, 1e-6, 200'000}.draw(few);
  CHECK(few.most_gaussians(1) == PictureDetail::kFewestGaussians);
  CHECK(PictureDetail::kQualities[few.level(true)] == PictureQuality{true, 2});
}

TEST_CASE("keeps Gaussians and resolution if Scripts or the interface make frames slow") {
  PictureDetail detail;
  const auto draw_frames = [&](int frames, double each, double others) {
    for (int i = 0; i < frames; ++i) {
      const std::size_t level = detail.level(true),
                        count = level == 0 ? 2'000'000 : std::min<std::size_t>(2'000'000, detail.most_gaussians(level));
      const double picture = 0.002 + each * static_cast<double>(count);
      detail.note(level, false, picture + others, count, others);
    }
  };
  draw_frames(200, 60e-9, 0.2);
  // The picture has 40 % of the goal.
  CHECK(detail.level(true) == 1);
  CHECK(detail.most_gaussians(1) > 250'000);
  CHECK(detail.most_gaussians(1) < 450'000);
  draw_frames(300, 60e-9, 0.002);
  CHECK(detail.level(true) == 1);
  CHECK(detail.most_gaussians(1) > 600'000);
  // A fast picture stays at full quality.
  PictureDetail fast;
  for (int i = 0; i < 100; ++i) fast.note(fast.level(true), false, 0.31, 0, 0.3);
  CHECK(fast.level(true) == 0);
}

TEST_CASE("fades Gaussians at rest only if pictures are fast enough") {
  PictureDetail detail;
  CHECK(detail.fades(0));
  detail.note(0, false, 0.02, 100'000);
  CHECK(detail.fades(0));
  detail.note(0, false, 0.2, 2'000'000);
  CHECK_FALSE(detail.fades(0));
  CHECK(detail.fades(1));
  detail.note(1, false, 0.05, 300'000);
  CHECK_FALSE(detail.fades(0));
  detail.note(0, false, 0.03, 2'000'000);
  CHECK(detail.fades(0));
  detail.note(0, true, 0.5);
  CHECK_FALSE(detail.fades(0));
}

TEST_CASE("decodes for the first picture at rest as much as its time allows, and for later ones at least as much") {
  PictureDetail fast, slow, late;
  fast.note(0, false, 0.05);
  slow.note(0, false, 0.2);
  late.note(0, false, 0.6);
  for (PictureDetail* const detail : {&fast, &slow, &late}) {
    CHECK(detail->decoded_amounts(0) == 1);
    for (unsigned rests = 1; rests < 12; ++rests) {
      CHECK(detail->decoded_amounts(rests) >= std::min(std::size_t{1} << rests, std::size_t{32}));
      CHECK(detail->decoded_amounts(rests) <= 32);
    }
  }
  CHECK(fast.decoded_amounts(1) == 10);
  CHECK(slow.decoded_amounts(1) == 2);
  CHECK(slow.decoded_amounts(2) == 10);
  CHECK(late.decoded_amounts(1) == 2);
  CHECK(late.decoded_amounts(2) == 30);
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
