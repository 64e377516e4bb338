#include "render/gaussians/gaussian_levels.h"

#include "render/gaussians/gaussian_raster.h"
#include "render/splat/splat_pieces.h"
#include "tests/qnv/splat_clouds.h"

#include <glm/gtc/matrix_transform.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

namespace gs::render::gaussian_levels_test {
namespace {

using Pixels = std::vector<std::uint8_t>;
using Runs = std::vector<qnv::SplatRun>;

constexpr double kFrame = 1 / 30.0;

std::shared_ptr<const qnv::Gaussians> cloud(std::size_t count) {
  return std::make_shared<const qnv::Gaussians>(test::splat_cloud(count));
}

SplatView view_from(float away) {
  SplatView view;
  view.width = view.height = 128;
  view.tangents = glm::vec2(0.4f);
  view.near_plane = 0.05f;
  view.camera_from_node = glm::lookAt(glm::vec3(0, 0.1f * away, away), glm::vec3(0), glm::vec3(0, 1, 0));
  return view;
}

GaussianMotion motion_of(const SplatView& view, float coarseness, double time) {
  auto lod = lod_view(view);
  REQUIRE(lod);
  lod->error_pixels = coarseness;
  return {*lod, coarseness, time};
}

/// Draws the runs, or all Gaussians if `runs` is null.
Pixels picture(const std::shared_ptr<const qnv::Gaussians>& all, const Runs* runs, const SplatView& view) {
  std::vector<GaussianItem> items;
  const auto add = [&](const qnv::Gaussians& gaussians, std::size_t first, std::size_t count, float presence) {
    GaussianItem& item = items.emplace_back();
    item.gaussians = &gaussians;
    item.camera_from_node = view.camera_from_node;
    item.first = first;
    item.count = count;
    item.presence = presence;
  };
  if (!runs) add(*all, 0, all->size(), 1);
  if (runs)
    for (const qnv::SplatRun& run : *runs) add(*run.splats, run.first, run.count, run.presence);
  return rasterize_gaussians(items, view).pixels;
}

double decibels(const Pixels& a, const Pixels& b) {
  REQUIRE(a.size() == b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return 10 * std::log10(255 * 255 * static_cast<double>(a.size()) / std::max(sum, 1e-6));
}

void wait_for(const GaussianLevels& levels) {
  for (int i = 0; i < 20'000 && levels.working(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  REQUIRE_FALSE(levels.working());
}

}  // namespace

TEST_CASE("draws fewer Gaussians of a file while the view moves, and all of them 0.3 s later, without popping") {
  const auto all = cloud(20'000);
  GaussianLevels levels(1000);
  bool pending = false;
  float away = 20;
  double time = 5;
  // At rest, no levels are necessary.
  CHECK(levels.cut(all, motion_of(view_from(away), 1, time), false, pending) == nullptr);
  CHECK_FALSE(levels.working());
  // The first picture of a motion starts the thread and has all Gaussians.
  CHECK(levels.cut(all, motion_of(view_from(away), 2.5f, time), false, pending) == nullptr);
  CHECK(levels.working());
  wait_for(levels);
  CHECK_FALSE(pending);

  Pixels last = picture(all, nullptr, view_from(away));
  double least_change = 1000, least_moving = 1000;
  std::size_t fewest = all->size();
  const auto draw = [&](float coarseness) {
    const SplatView view = view_from(away);
    pending = false;
    const Runs* const runs = levels.cut(all, motion_of(view, coarseness, time), false, pending);
    const Pixels drawn = picture(all, runs, view);
    if (runs) {
      std::size_t count = 0;
      for (const qnv::SplatRun& run : *runs) count += run.count;
      fewest = std::min(fewest, count);
      least_moving = std::min(least_moving, decibels(drawn, picture(all, nullptr, view)));
    }
    return std::pair(runs != nullptr, drawn);
  };
  // The eye stays, so that only levels change the picture.
  for (int frame = 0; frame < 15; ++frame, time += kFrame) {
    const auto [coarse, drawn] = draw(2.5f);
    CHECK(coarse);
    least_change = std::min(least_change, decibels(drawn, last));
    last = drawn;
  }
  CHECK(fewest < all->size() * 2 / 3);
  CHECK_FALSE(pending);
  for (int frame = 0; frame < 20; ++frame, time += kFrame) {
    away -= 0.1f;
    CHECK(draw(2.5f).first);
  }
  last = draw(2.5f).second;
  int frames = 0;
  for (bool coarse = true; coarse && frames < 30; ++frames, time += kFrame) {
    auto [is_coarse, drawn] = draw(1);
    coarse = is_coarse;
    CHECK(pending == coarse);
    least_change = std::min(least_change, decibels(drawn, last));
    last = std::move(drawn);
  }
  INFO("coarse " << least_moving << " dB, changes " << least_change << " dB, " << fewest << " Gaussians, " << frames
                 << " frames to rest");
  CHECK(frames <= 10);
  CHECK(last == picture(all, nullptr, view_from(away)));
  CHECK(least_moving > 33);
  CHECK(least_change > 40);
  CHECK(levels.cut(all, motion_of(view_from(away), 1, time), false, pending) == nullptr);
}

TEST_CASE("draws all Gaussians of a file at once after a motion if changes do not fade") {
  const auto all = cloud(20'000);
  GaussianLevels levels(1000);
  bool pending = false;
  (void)levels.cut(all, motion_of(view_from(20), 2.5f, 1), false, pending);
  wait_for(levels);
  CHECK(levels.cut(all, motion_of(view_from(20), 2.5f, 1), false, pending) != nullptr);
  pending = false;
  GaussianMotion rest = motion_of(view_from(20), 1, 1.05);
  rest.fades = false;
  CHECK(levels.cut(all, rest, false, pending) == nullptr);
  CHECK_FALSE(pending);
  // The next motion starts with a cut as fine as the Gaussians of the file.
  const Runs* const runs = levels.cut(all, motion_of(view_from(20), 2.5f, 1.1), false, pending);
  REQUIRE(runs);
  CHECK(decibels(picture(all, runs, view_from(20)), picture(all, nullptr, view_from(20))) > 40);
}

TEST_CASE("gives up the levels of Gaussians that are replaced, and starts again with the next motion") {
  auto first = cloud(20'000);
  GaussianLevels levels(1000, std::chrono::hours(1));
  bool pending = false;
  const auto start = [&](const std::shared_ptr<const qnv::Gaussians>& gaussians, float coarseness) {
    (void)levels.cut(gaussians, motion_of(view_from(20), coarseness, 1), true, pending);
  };
  start(first, 1);
  CHECK(levels.working());
  levels.forget_unused();
  CHECK(levels.working());
  first.reset();
  levels.forget_unused();
  CHECK_FALSE(levels.working());
  auto second = cloud(5000);
  start(second, 1);  // waits, because a series of Gaussians would never use its levels
  CHECK(levels.working());
  second.reset();
  levels.forget_unused();
  CHECK_FALSE(levels.working());
  const auto third = cloud(5000);
  start(third, 1);
  CHECK(levels.working());
  start(third, 2.5f);
  wait_for(levels);
}

TEST_CASE("makes levels without a motion once replaced Gaussians are steady") {
  auto first = cloud(20'000);
  GaussianLevels levels(1000, std::chrono::milliseconds(1));
  bool pending = false;
  const auto draw = [&](const std::shared_ptr<const qnv::Gaussians>& gaussians, float coarseness, bool eager) {
    return levels.cut(gaussians, motion_of(view_from(20), coarseness, 1), eager, pending) != nullptr;
  };
  CHECK_FALSE(draw(first, 1, true));
  first.reset();
  levels.forget_unused();
  const auto last = cloud(5000);  // the last version of a streamed file
  CHECK_FALSE(draw(last, 1, true));
  CHECK(levels.working());
  wait_for(levels);
  CHECK(draw(last, 2.5f, false));
}

TEST_CASE("charges levels to the budget of the world, and does without if it refuses") {
  bool pending = false;
  const auto all = cloud(20'000);
  const auto budget = std::make_shared<Budget>();
  const auto draw = [&](GaussianLevels& levels, const std::shared_ptr<Budget>& from) {
    GaussianMotion motion = motion_of(view_from(20), 2.5f, 1);
    motion.budget = from;
    return levels.cut(all, motion, true, pending) != nullptr;
  };
  {
    GaussianLevels levels(1000);
    CHECK_FALSE(draw(levels, budget));
    wait_for(levels);
    CHECK(draw(levels, budget));
    // The stream, decoded clusters, and a cut.
    CHECK(budget->used(Resource::vectors) == 20'000 * (12 + 2 * qnv::bytes_of_splat(0)));
  }
  CHECK(budget->used(Resource::vectors) == 0);
  Limits limits;
  limits.memory = 1 << 20;
  const auto small = std::make_shared<Budget>(limits);
  GaussianLevels levels(1000);
  CHECK_FALSE(draw(levels, small));
  CHECK_FALSE(levels.working());
  CHECK_FALSE(draw(levels, small));
  CHECK(small->used(Resource::vectors) == 0);
  // After other data is freed, the Gaussians get their levels.
  {
    Share other(budget, Resource::vectors);
    REQUIRE(other.grow(budget->left(Resource::vectors)));
    CHECK_FALSE(draw(levels, budget));
    CHECK_FALSE(levels.working());
  }
  CHECK_FALSE(draw(levels, budget));
  wait_for(levels);
  CHECK(draw(levels, budget));
}

TEST_CASE("moves with coarse Gaussians at once if the cache has freed the fine ones") {
  const auto all = cloud(20'000);
  GaussianLevels levels(1000);
  bool pending = false;
  GaussianMotion motion = motion_of(view_from(20), 2.5f, 1);
  (void)levels.cut(all, motion, false, pending);
  wait_for(levels);
  motion.view.most_decoded = 1;
  // The levels of this part of the view are not decoded yet.
  motion.view.eye = {0, 0, 0.5f};
  const Runs* const runs = levels.cut(all, motion, false, pending);
  REQUIRE(runs);
  CHECK(pending);
  std::size_t count = 0;
  for (const qnv::SplatRun& run : *runs) count += run.count;
  CHECK(count > 0);
  CHECK(count < all->size());
}

TEST_CASE("has no levels of few or invalid Gaussians") {
  GaussianLevels levels(1000);
  bool pending = false;
  const auto few = cloud(500);
  CHECK(levels.cut(few, motion_of(view_from(20), 2.5f, 1), true, pending) == nullptr);
  CHECK_FALSE(levels.working());
  qnv::Gaussians invalid = test::splat_cloud(2000);
  for (glm::vec3& position : invalid.positions) position.x = std::numeric_limits<float>::quiet_NaN();
  const auto shared = std::make_shared<const qnv::Gaussians>(std::move(invalid));
  for (int round = 0; round < 2; ++round) {
    CHECK(levels.cut(shared, motion_of(view_from(20), 2.5f, 1), true, pending) == nullptr);
    wait_for(levels);
  }
  CHECK_FALSE(pending);
}

}  // namespace gs::render::gaussian_levels_test
