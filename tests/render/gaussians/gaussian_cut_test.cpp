#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/rays/splat_pick.h"
#include "render/splat/splat_pieces.h"
#include "tests/qnv/splat_clouds.h"

#include <glm/gtc/matrix_transform.hpp>

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

namespace gs::render::gaussian_cut_test {
namespace {

using Pixels = std::vector<std::uint8_t>;

qnv::EncodedStream encoded_cloud() {
  auto encoded = qnv::encode_gaussians(test::splat_cloud(20'000), {});
  return std::get<qnv::EncodedStream>(std::move(encoded));
}

std::shared_ptr<qnv::SplatStream> stream_of(const qnv::EncodedStream& encoded) {
  auto opened = qnv::SplatStream::open(encoded.bytes);
  return std::get<std::unique_ptr<qnv::SplatStream>>(std::move(opened));
}

SplatView view_from(float away) {
  SplatView view;
  view.width = view.height = 128;
  view.tangents = glm::vec2(0.4f);
  view.near_plane = 0.05f;
  view.camera_from_node = glm::lookAt(glm::vec3(0, 0.1f * away, away), glm::vec3(0), glm::vec3(0, 1, 0));
  return view;
}

Pixels picture(const std::vector<qnv::SplatRun>& runs, const SplatView& view) {
  std::vector<GaussianItem> items;
  for (const qnv::SplatRun& run : runs) {
    GaussianItem& item = items.emplace_back();
    item.gaussians = run.splats.get();
    item.camera_from_node = view.camera_from_node;
    item.first = run.first;
    item.count = run.count;
    item.presence = run.presence;
  }
  return rasterize_gaussians(items, view).pixels;
}

Pixels cut_picture(qnv::SplatStream& stream, const SplatView& view, float error, std::optional<double> time) {
  auto lod = lod_view(view);
  REQUIRE(lod);
  lod->error_pixels = error;
  return picture(stream.cut(*lod, time), view);
}

double squared_difference(const Pixels& a, const Pixels& b) {
  REQUIRE(a.size() == b.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum / static_cast<double>(a.size());
}

double decibels(const Pixels& a, const Pixels& b) {
  return 10 * std::log10(255 * 255 / std::max(squared_difference(a, b), 1e-6));
}

}  // namespace

TEST_CASE("a cut of Gaussians has the picture of all of them") {
  const qnv::EncodedStream encoded = encoded_cloud();
  const qnv::Gaussians all = stream_of(encoded)->whole().decode(100'000);
  REQUIRE(all.size() == 20'000);
  for (const float away : {3.0f, 8.0f, 25.0f}) {
    const auto stream = stream_of(encoded);
    const SplatView view = view_from(away);
    GaussianItem item;
    item.gaussians = &all;
    item.count = all.size();
    item.camera_from_node = view.camera_from_node;
    const Pixels expected = rasterize_gaussians({&item, 1}, view).pixels;
    const double own = decibels(cut_picture(*stream, view, 1, {}), expected),
                 coarse = decibels(cut_picture(*stream, view, 8, {}), expected);
    INFO(away << ": " << own << " dB, coarse " << coarse << " dB");
    CHECK(own > 40);
    CHECK(coarse < own);
  }
}

// Compares each picture with one of an equal view and the previous cut, so that motion does not count.
TEST_CASE("cuts of Gaussians change without popping") {
  const qnv::EncodedStream encoded = encoded_cloud();
  constexpr float kCoarse = 6;  // pixels, so that changes are visible
  double least_faded = 1000, least_sudden = 1000;
  for (const bool fades : {true, false}) {
    const auto stream = stream_of(encoded);
    std::vector<qnv::SplatRun> last;
    for (int frame = 0; frame < 60; ++frame) {
      const SplatView view = view_from(9 - 0.07f * static_cast<float>(frame));
      auto lod = lod_view(view);
      REQUIRE(lod);
      lod->error_pixels = kCoarse;
      const std::vector<qnv::SplatRun> runs = stream->cut(*lod, fades ? std::optional(frame / 30.0) : std::nullopt);
      if (frame > 0 && runs != last) {
        double& least = fades ? least_faded : least_sudden;
        least = std::min(least, decibels(picture(runs, view), picture(last, view)));
      }
      last = runs;
    }
  }
  INFO("least PSNR of a change: " << least_faded << " dB, without fading " << least_sudden << " dB");
  CHECK(least_sudden < 48);
  CHECK(least_faded > least_sudden + 4);
}

TEST_CASE("draws equal Gaussians after pictures with more, fewer and no Gaussians") {
  const qnv::Gaussians many = test::splat_cloud(30'000), few = test::splat_cloud(500);
  const SplatView view = view_from(20);
  const auto drawn = [&](const qnv::Gaussians& gaussians) {
    GaussianItem item;
    item.gaussians = &gaussians;
    item.camera_from_node = view.camera_from_node;
    item.count = gaussians.size();
    return rasterize_gaussians({&item, 1}, view).pixels;
  };
  const Pixels first = drawn(few), second = drawn(many);
  CHECK(first != second);
  CHECK(drawn(few) == first);
  CHECK(drawn(many) == second);
  for (int i = 0; i < 20; ++i) note_picture_without_gaussians();
  CHECK(drawn(few) == first);
}

TEST_CASE("two shares of a Gaussian have about the opacity of the whole one") {
  for (const float opacity : {0.1f, 0.6f, 0.99f}) {
    float last = 0;
    for (int step = 1; step <= 20; ++step) {
      const float share = static_cast<float>(step) / 20, one = faded_opacity(opacity, share),
                  other = faded_opacity(opacity, 1 - share);
      CHECK(1 - (1 - one) * (1 - other) == Approx(opacity).margin(0.12));
      CHECK(one >= last);
      CHECK(one - last < 0.11f);  // no sudden change
      last = one;
    }
    CHECK(last == opacity);
  }
}

TEST_CASE("a ray hits the Gaussians of a stream") {
  const qnv::EncodedStream encoded = encoded_cloud();
  qnv::Gaussians gaussians;
  gaussians.stream = stream_of(encoded);
  gaussians.description = gaussians.stream->header().description;
  const qnv::Geometry all(gaussians.stream->whole().decode(100'000)), streamed(std::move(gaussians));
  PickRay ray;
  ray.origin = {0.2, 0.1, 4};
  ray.direction = glm::vec3(0, 0, -1);
  const auto expected = pick_disc(all, glm::dmat4(1), ray), hit = pick_disc(streamed, glm::dmat4(1), ray);
  REQUIRE(expected);
  REQUIRE(hit);
  CHECK(hit->distance == Approx(expected->distance).margin(0.05));
  CHECK(hit->color);
}

}  // namespace gs::render::gaussian_cut_test
