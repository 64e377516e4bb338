#include "app/view/derived/volume_histogram.h"

#include "tests/app/view/derived/volume_balls.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstring>
#include <vector>

namespace gs::app::volume_histogram_test {
namespace {

/// Returns the histogram of these values.
VolumeHistogram histogram_of(const std::vector<float>& values) {
  qnv::VolumeSource source;
  source.layout.dimensions = {static_cast<std::uint32_t>(values.size()), 1, 1};
  source.layout.type = qnv::VoxelType::f32;
  source.read = [&values](std::uint32_t, std::span<std::byte> to) {
    std::memcpy(to.data(), values.data(), to.size());
    return true;
  };
  return VolumeHistogram(*test_balls::grid_of(source));
}

}  // namespace

TEST_CASE("counts the values of a volume on a logarithmic scale, without missing ones") {
  std::vector<float> values(100, -50);
  values.resize(110, 205);
  values.resize(115, 0);
  values.resize(140, std::nanf(""));
  const VolumeHistogram histogram = histogram_of(values);
  CHECK(histogram.range() == std::pair<float, float>{-50, 205});
  CHECK(histogram.log_counts()[0] == 1);
  CHECK(histogram.log_counts()[255] == Approx(std::log(11) / std::log(101)));
  CHECK(histogram.log_counts()[50] == Approx(std::log(6) / std::log(101)));
  CHECK(histogram.log_counts()[100] == 0);
}

TEST_CASE("finds the values that a part of all values does not exceed") {
  std::vector<float> values;
  for (int i = 0; i <= 1000; ++i) values.push_back(static_cast<float>(i));
  const VolumeHistogram histogram = histogram_of(values);
  CHECK(histogram.percentile(0) == Approx(0).margin(0.5));
  CHECK(histogram.percentile(0.02) == Approx(20).margin(1.5));
  CHECK(histogram.percentile(0.98) == Approx(980).margin(1.5));
  CHECK(histogram.percentile(1) == Approx(1000).margin(0.5));
  const auto [low, high] = contrast_range(histogram);
  CHECK(low == Approx(20).margin(1.5));
  CHECK(high == Approx(980).margin(1.5));
  // A range without outliers that is empty becomes the whole range.
  std::vector<float> flat(1000, 7);
  flat.push_back(9);
  CHECK(contrast_range(histogram_of(flat)) == std::pair<float, float>{7, 9});
  CHECK(contrast_range(histogram_of({5, 5})) == std::pair<float, float>{5, 5});
}

TEST_CASE("proposes an isovalue between two classes of values") {
  std::vector<float> values;
  for (int i = 0; i < 500; ++i) values.push_back(static_cast<float>(i % 10));
  for (int i = 0; i < 300; ++i) values.push_back(static_cast<float>(1000 + i % 20));
  const float value = histogram_of(values).threshold();
  CHECK(value > 400);
  CHECK(value < 600);
  CHECK(std::isfinite(histogram_of({5, 5}).threshold()));
}

}  // namespace gs::app::volume_histogram_test
