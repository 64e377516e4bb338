#include "render/volume/layers_together.h"

#include "render/gaussians/gaussian_raster.h"
#include "tests/render/gaussians/gaussian_scenes.h"
#include "tests/render/volume_scenes.h"

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace gs::render::layers_together_test {

using namespace test;

namespace {

constexpr std::size_t kPixels = std::size_t{48} * 36;

SplatView view_from(const glm::vec3& eye) {
  SplatView view;
  view.camera_from_node = glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 1, 0));
  view.width = 48;
  view.height = 36;
  view.tangents = {0.48f, 0.36f};
  view.near_plane = 0.05f;
  return view;
}

LayerRaster raster_of(const VolumeItem& item) {
  return [item](const SplatView& view, const VolumeStops& stops) { return rasterize_volumes({&item, 1}, view, stops); };
}

double decibels(std::span<const std::uint8_t> pixels, const RayImage& exact) {
  REQUIRE(pixels.size() == 4 * exact.color.size());
  Psnr psnr;
  for (std::size_t i = 0; i < exact.color.size(); ++i)
    for (int c = 0; c < 4; ++c)
      psnr.add(pixels[4 * i + static_cast<std::size_t>(c)] / 255.0, static_cast<double>(exact.color[i][c]));
  return psnr.decibels();
}

}  // namespace

TEST_CASE("blends overlapping contents by depth, close to an exact picture of both, with stops", "[optimised]") {
  const qnv::Volume first = random_volume(6000, 9, 0.06f), second = random_volume(600, 4, 0.2f);
  const VolumeModel models[2] = {volume_model(first), volume_model(second)};
  const SplatView view = view_from({1, 1, 3});
  std::array<VolumeItem, 2> items{
      VolumeItem{&first, &models[0], view.camera_from_node, first.size(), {}},
      VolumeItem{&second, &models[1], glm::translate(view.camera_from_node, {0.3f, 0, 0}), second.size(), {}}};
  items[0].options.opacity = 0.2f;
  items[1].options.opacity = 0.6f;
  const std::array<LayerRaster, 2> contents{raster_of(items[0]), raster_of(items[1])};
  const DepthRange range{1.8f, 4.9f};
  const RayImage exact = exact_volumes(items, view);
  const VolumeLayer together = rasterize_together(contents, view, {}, range);
  CHECK(together.vectors ==
        rasterize_volumes({&items[0], 1}, view).vectors + rasterize_volumes({&items[1], 1}, view).vectors);
  // From the inside of the range, nothing is in front of it.
  CHECK(rasterize_together(contents, view, {}, {0, 4.9f}).vectors == together.vectors);
  CHECK(together.edge_pixels.empty());
  CHECK(together.depth.empty());
  // Without slabs in the range, the first content is in front in one half, and the second one in the other.
  const double own = decibels(together.pixels, exact),
               fine = decibels(rasterize_together(contents, view, {}, range, 40).pixels, exact),
               halves = decibels(rasterize_together(contents, view, {}, range, 0).pixels, exact);
  INFO(own << " dB, with 40 slabs " << fine << " dB, with none " << halves << " dB");
  CHECK(own > 34);
  CHECK(fine > 38);
  CHECK(own > halves + 4);

  constexpr float kFar = std::numeric_limits<float>::infinity();
  std::vector<float> near(kPixels, kFar), far(kPixels, kFar);
  for (std::size_t i = 0; i < kPixels; ++i) {
    if (i % 48 > 24) near[i] = far[i] = 3.2f;
    if (i % 48 == 24) near[i] = 3.2f;
    if (i % 48 > 43) near[i] = far[i] = 0.5f;
  }
  const VolumeLayer stopped = rasterize_together(contents, view, {near, far}, range);
  CHECK(decibels(stopped.pixels, exact_volumes(items, view, far)) > 34);
  CHECK(decibels(stopped.edge_pixels, exact_volumes(items, view, near)) > 34);
  SplatView threaded = view;
  threaded.threads = 3;
  CHECK(rasterize_together(contents, threaded, {near, far}, range).pixels == stopped.pixels);
}

TEST_CASE("shows Gaussians inside of a volume, and the volume in front of and behind them") {
  const qnv::Volume volume = random_volume(6000, 9, 0.06f);
  const VolumeModel model = volume_model(volume);
  const SplatView view = view_from({0, 0, 3});
  VolumeItem haze{&volume, &model, view.camera_from_node, volume.size(), {}};
  haze.options.opacity = 0.1f;
  const qnv::Gaussians gaussians = random_gaussians(200, 0, 3);
  GaussianItem item;
  item.gaussians = &gaussians;
  item.count = gaussians.size();
  item.camera_from_node = view.camera_from_node;
  const LayerRaster volumes = raster_of(haze), splats = [&](const SplatView&part, const VolumeStops&stops) {
    return rasterize_gaussians({&item, 1}, part, stops, false);
  };
  const LayerRaster nothing = [](const SplatView&, const VolumeStops&) { return VolumeLayer{}; };
  const DepthRange range{1.8f, 4.2f};
  const std::vector<std::uint8_t> both = rasterize_together({volumes, splats}, view, {}, range).pixels,
                                  exact = rasterize_together({volumes, splats}, view, {}, range, 300).pixels,
                                  behind = rasterize_together({volumes, splats}, view, {}, {5, 6}, 1).pixels,
                                  before = rasterize_together({splats, volumes}, view, {}, {5, 6}, 1).pixels;
  INFO(psnr_of(both, exact) << " dB; Gaussians behind " << psnr_of(behind, exact) << " dB, before "
                            << psnr_of(before, exact) << " dB");
  CHECK(psnr_of(both, exact) > 34);
  CHECK(psnr_of(both, exact) > psnr_of(behind, exact) + 4);
  CHECK(psnr_of(both, exact) > psnr_of(before, exact) + 6);
  // A content that is alone looks the same in slabs as in one piece.
  CHECK(psnr_of(rasterize_together({nothing, splats}, view, {}, range).pixels, splats(view, {}).pixels) > 45);
  CHECK(rasterize_together({nothing, nothing}, view, {}, range).empty());
  CHECK(rasterize_together({nothing, splats}, SplatView{}, {}, range).empty());
}

}  // namespace gs::render::layers_together_test
