#include "render/splat/splat_pieces.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/volume_detail.h"
#include "render/scene/color_ramps.h"
#include "render/splat/splat_budget.h"
#include "tests/render/splat_scenes.h"

#include <glm/gtc/matrix_transform.hpp>

#include <limits>
#include <numeric>
#include <set>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

std::size_t total(const SplatCut& cut) {
  std::size_t sum = 0;
  for (const SharedSplatPiece& piece : cut.pieces) sum += piece.count;
  return sum;
}

SplatView from(const glm::vec3& eye) {
  SplatView view;
  view.camera_from_node = glm::lookAt(eye, glm::vec3(0), glm::vec3(0.1f, 1, 0.05f));
  view.tangents = {0.5f, 0.5f};
  view.width = view.height = 400;
  view.near_plane = 0.01f;
  return view;
}

/// Returns a ball of radius 1 at `place`.
SplatItem ball_at(const glm::vec3& place, std::size_t vectors) {
  SplatItem item;
  item.geometry = shared_geometry(sphere(vectors));
  item.world_from_node[3] = glm::vec4(place, 1);
  return item;
}

std::size_t sum_of(const std::vector<std::size_t>& shares) {
  return std::accumulate(shares.begin(), shares.end(), std::size_t{0});
}

constexpr std::size_t kNoLimit = std::numeric_limits<std::size_t>::max();

}  // namespace

TEST_CASE("makes colour ramps from blue to red, and different colours for neighbouring chunks") {
  const auto same = [](const qnv::Rgb8& c, int r, int g, int b) {
    return c == qnv::Rgb8{std::uint8_t(r), std::uint8_t(g), std::uint8_t(b)};
  };
  CHECK(same(age_color(0), 0, 0, 255));
  CHECK(same(age_color(0.5), 0, 255, 0));
  CHECK(same(age_color(1), 255, 0, 0));
  CHECK(same(age_color(0.25), 0, 255, 255));
  CHECK(same(age_color(7), 255, 0, 0));
  CHECK(same(age_color(std::nan("")), 0, 0, 255));
  CHECK(same(level_color(0, 10), 0, 0, 255));
  CHECK(same(level_color(10, 10), 255, 0, 0));
  CHECK(same(level_color(200, 10), 255, 0, 0));
  CHECK(same(level_color(0, 0), 255, 0, 0));
  CHECK(same(hue_color(-1), 255, 0, 0));
  CHECK(same(hue_color(std::numeric_limits<double>::infinity()), 255, 0, 0));
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const qnv::Rgb8 a = chunk_color(i), b = chunk_color(i + 1);
    CHECK(std::abs(a.r - b.r) + std::abs(a.g - b.g) + std::abs(a.b - b.b) > 100);
  }
  CHECK(octave_of(0) == 0);
  CHECK(octave_of(63) == 0);
  CHECK(octave_of(64) == 1);
  CHECK(octave_of(127) == 1);
  CHECK(octave_of(128) == 2);
  CHECK(octave_of(kNoLimit) <= 63);
}

TEST_CASE("draws a prefix of splats without levels, and splits it where the colours change") {
  const auto geometry = shared_geometry(sphere(10000));
  CutOptions options;
  CHECK(total(cut_splats(geometry, from({0, 0, 3}), options)) == 10000);
  options.budget = 2500;
  SplatCut cut = cut_splats(geometry, from({0, 0, 3}), options);
  REQUIRE(cut.pieces.size() == 1);
  CHECK(cut.pieces[0].count == 2500);
  CHECK(cut.pieces[0].growth == 4);
  CHECK(!cut.pieces[0].tint);
  CHECK(!cut.pending);

  for (const ColorBy color_by : {ColorBy::level, ColorBy::chunk, ColorBy::age}) {
    for (const std::size_t budget : {1u, 64u, 65u, 9999u, 0u}) {
      options.color_by = color_by;
      options.budget = budget;
      cut = cut_splats(geometry, from({0, 0, 3}), options);
      std::size_t next = 0;
      for (const SharedSplatPiece& piece : cut.pieces) {
        CHECK(piece.first == next);
        CHECK(piece.count > 0);
        CHECK(piece.tint.has_value());
        next += piece.count;
      }
      CHECK(next == (budget == 0 ? 10000 : budget));
    }
  }
  CHECK(cut.pieces.size() == 64);     // by age
  options.color_by = ColorBy::level;  // 64, 64, 128, ... 4096, 1808
  cut = cut_splats(geometry, from({0, 0, 3}), options);
  REQUIRE(cut.pieces.size() == 9);
  CHECK(cut.pieces[2].first == 128);
  CHECK(*cut.pieces.front().tint == qnv::Rgb8{0, 0, 255});
  CHECK(*cut.pieces.back().tint == qnv::Rgb8{255, 0, 0});
  options.color_by = ColorBy::age;
  cut = cut_splats(geometry, from({0, 0, 3}), options);
  CHECK(*cut.pieces.front().tint == qnv::Rgb8{0, 0, 255});
  CHECK(*cut.pieces.back().tint == qnv::Rgb8{255, 0, 0});
  options.color_by = ColorBy::chunk;
  CHECK(cut_splats(geometry, from({0, 0, 3}), options).pieces.size() == 3);
  CHECK(cut_splats(std::make_shared<qnv::Geometry>(), from({0, 0, 3}), options).pieces.empty());
}

TEST_CASE("cuts a stream for the view at the requested detail") {
  const auto stream = bumpy_stream(60000);
  CutOptions options;
  const std::size_t near = total(cut_splats(stream, from({0, 0, 3}), options)),
                    far = total(cut_splats(stream, from({0, 0, 60}), options));
  CHECK(near > 5000);
  CHECK(far < near / 4);
  options.detail = 0.25f;
  const std::size_t coarse = total(cut_splats(stream, from({0, 0, 12}), options));
  options.detail = 4;
  const std::size_t fine = total(cut_splats(stream, from({0, 0, 12}), options));
  CHECK(coarse < fine / 2);
  options.detail = 1;
  options.budget = 3000;
  CHECK(total(cut_splats(stream, from({0, 0, 3}), options)) <= 3000);
  options.budget = 0;
  for (const ColorBy color_by : {ColorBy::level, ColorBy::chunk, ColorBy::age}) {
    options.color_by = color_by;
    const SplatCut cut = cut_splats(stream, from({0, 0, 3}), options);
    std::set<std::array<int, 3>> colors;
    for (const SharedSplatPiece& piece : cut.pieces) {
      REQUIRE(piece.tint.has_value());
      colors.insert({piece.tint->r, piece.tint->g, piece.tint->b});
    }
    CHECK(colors.size() > 1);
  }
  options.color_by = ColorBy::own;
  // A stream loads gradually, and reports pending data until the cut is complete.
  const auto again = bumpy_stream(60000);
  options.most_decoded = 2000;
  std::size_t frames = 0, last = 0;
  for (bool pending = true; pending && frames < 1000; ++frames) {
    const SplatCut cut = cut_splats(again, from({0, 0, 3}), options);
    last = total(cut);
    pending = cut.pending;
  }
  CHECK(frames > 3);
  CHECK(frames < 1000);
  CHECK(last == near);
  SplatView broken = from({0, 0, 3});
  broken.camera_from_node[3].x = std::numeric_limits<float>::quiet_NaN();
  CHECK(cut_splats(stream, broken, options).pieces.empty());
}

TEST_CASE("spends the budget in proportion to pixels") {
  const BudgetView view{glm::dmat4(1), {0.5f, 0.5f}, 400, 400};
  SECTION("None: no limits") {
    const std::vector<SplatItem> items{ball_at({0, 0, -3}, 100), ball_at({0, 0, -30}, 100)};
    CHECK(share_budget(items, view, 0) == std::vector<std::size_t>{0, 0});
    CHECK(share_budget({}, view, 100).empty());
  }
  SECTION("Pixels of a ball: its outline, and no more than the picture") {
    // sin = 1 / 10: the outline of the box's ball has a radius of 200 / 0.5 * tan(asin(0.1)) pixels.
    const double radius = 400 * std::tan(std::asin(std::sqrt(3.0) / 10));
    CHECK(pixels_covered(ball_at({0, 0, -10}, 10), view) == Approx(3.14159265 * radius * radius));
    CHECK(pixels_covered(ball_at({0, 0, -1}, 10), view) == 160000);
    CHECK(pixels_covered(ball_at({0, 0, 10}, 10), view) == 0);
    CHECK(pixels_covered(ball_at({30, 0, -10}, 10), view) == 0);
    CHECK(pixels_covered(ball_at({0, std::nanf(""), -10}, 10), view) == 0);
    CHECK(pixels_covered(ball_at({1e38f, 0, -1e38f}, 10), view) >= 0);
  }
  SECTION("By projected size") {
    const std::vector<SplatItem> items{ball_at({0, 0, -10}, 100000), ball_at({0, 0, -40}, 100000)};
    const auto shares = share_budget(items, view, 16000);
    CHECK(sum_of(shares) <= 16000);
    CHECK(sum_of(shares) >= 15990);
    // The item covers a sixteenth of the pixels, so it gets a sixteenth of the budget.
    CHECK(static_cast<double>(shares[1]) == Approx(1000 + 14000.0 / 17).epsilon(0.02));
  }
  SECTION("What one cannot use goes to the others") {
    const std::vector<SplatItem> items{ball_at({0, 0, -5}, 500), ball_at({0, 0, -50}, 100000)};
    const auto shares = share_budget(items, view, 16000);
    CHECK(shares[0] == 500);
    CHECK(shares[1] >= 15490);
  }
  SECTION("A base for each, even out of view") {
    const std::vector<SplatItem> items{ball_at({0, 0, -3}, 100000), ball_at({0, 0, -3000}, 100000),
                                       ball_at({0, 0, 300}, 100000)};
    const auto shares = share_budget(items, view, 24000);
    CHECK(shares[1] >= 1000);
    CHECK(shares[2] == 1000);
    CHECK(shares[0] > 20000);
  }
  SECTION("Times the detail") {
    std::vector<SplatItem> items{ball_at({-1, 0, -10}, 100000), ball_at({1, 0, -10}, 100000)};
    items[0].detail = 3;
    const auto shares = share_budget(items, view, 16000);
    CHECK(static_cast<double>(shares[0]) == Approx(1000 + 14000 * 0.75).epsilon(0.01));
    items.resize(1);
    items[0].detail = 0.5f;
    CHECK(share_budget(items, view, 16000) == std::vector<std::size_t>{8000});
  }
  SECTION("Volumes that views make finer use the rest") {
    struct Finer final : qnv::VolumeDetail {
      std::shared_ptr<const qnv::Volume> cut(const qnv::LodView&, bool&) override { return nullptr; }
      [[nodiscard]] std::shared_ptr<const qnv::Volume> latest() const override { return nullptr; }
      [[nodiscard]] std::uint64_t revision() const override { return 0; }
    };
    SplatItem item = ball_at({0, 0, -5}, 100);
    qnv::GeometryBase base;
    base.description = item.geometry->description();
    qnv::Volume volume(std::move(base));
    volume.positions.resize(100, glm::vec3(0));
    item.geometry = std::make_shared<const qnv::Geometry>(volume);
    CHECK(share_budget(std::vector{item}, view, 16000)[0] <= 100);
    volume.detail = std::make_shared<Finer>();
    item.geometry = std::make_shared<const qnv::Geometry>(volume);
    CHECK(share_budget(std::vector{item}, view, 16000)[0] >= 15990);
  }
  SECTION("Streams that want less than they have leave the rest to others") {
    SplatItem far = ball_at({0, 0, -200}, 0), near = ball_at({0, 0, -4}, 1'000'000);
    far.geometry = bumpy_stream(60000);
    const std::vector<SplatItem> items{far, near};
    const auto shares = share_budget(items, view, 400'000);
    CHECK(shares[0] < 30000);
    CHECK(shares[1] > 350'000);
  }
  SECTION("Many") {
    std::vector<SplatItem> items(5000, ball_at({0, 0, -10}, 3));
    const auto shares = share_budget(items, view, 1000);
    CHECK(*std::min_element(shares.begin(), shares.end()) == 1);
    CHECK(sum_of(shares) == 5000);
  }
}
