#include "render/gaussians/gaussian_overlap.h"

#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "render/gaussians/gaussian_pass.h"
#include "tests/qnv/splat_clouds.h"
#include "tests/render/gaussians/gaussian_scenes.h"
#include "tests/render/volume_scenes.h"

#include <glm/gtc/matrix_transform.hpp>

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <variant>

namespace gs::render::gaussian_overlap_test {

using namespace test;
using testing::translation;

namespace {

const glm::vec3 kSky(0.2f, 0.4f, 0.8f);

/// Returns a thin haze with Gaussians inside of it.
RenderList haze_with_gaussians(std::size_t count) {
  qnv::Volume volume = random_volume(6000, 9, 0.06f);
  qnv::Gaussians gaussians = random_gaussians(count, 1, 3);
  for (auto* const own : {&volume.description, &gaussians.description}) {
    own->box = {};
    own->box.add(glm::vec3(-1));
    own->box.add(glm::vec3(1));
  }
  RenderList list;
  for (const auto& geometry :
       {std::make_shared<const qnv::Geometry>(volume), std::make_shared<const qnv::Geometry>(gaussians)}) {
    SplatItem item;
    item.geometry = geometry;
    list.splats.push_back(item);
  }
  return list;
}

/// Framebuffer, and the passes of Gaussians and volumes.
class Picture : public VolumePicture {
 public:
  explicit Picture(int samples) : VolumePicture(SortMethod::thread, 80, 60, samples) {
    gaussians = std::make_unique<GaussianPass>(gl, SortMethod::thread);
    options.splat_style.opacity = 0.15f;
  }
  ~Picture() {
    context->make_current();
    gaussians = nullptr;
  }

  /// Draws both contents in slabs, by a path, over a polygon. `slabs` replaces the number of slabs, unless it is 0.
  Pixels drawn(const RenderList& list, SplatPath path, std::size_t slabs = 0) {
    clear(kSky, 25);
    polygon({{{-0.9f, -0.9f, -2.6f}, {0.5f, -0.9f, -3}, {-0.9f, 0.1f, -2.8f}, {0.2f, 0.1f, -3.3f}}}, {1, 1, 0});
    options.splats = path;
    statistics = {};
    auto overlap = gaussians->overlap(list, camera, projection(), options, statistics);
    REQUIRE(overlap);
    CHECK(overlap->with_gl == (path == SplatPath::gl));
    if (slabs > 0) overlap->shared.slabs = slabs;
    pass->draw(list, camera, projection(), options, statistics, &*overlap);
    return read();
  }

  /// Draws one content over the other.
  Pixels ordered(const RenderList& list, bool gaussians_first) {
    clear(kSky, 25);
    polygon({{{-0.9f, -0.9f, -2.6f}, {0.5f, -0.9f, -3}, {-0.9f, 0.1f, -2.8f}, {0.2f, 0.1f, -3.3f}}}, {1, 1, 0});
    options.splats = SplatPath::gl;
    if (!gaussians_first) pass->draw(list, camera, projection(), options, statistics);
    gaussians->draw(list, camera, projection(), options, statistics);
    if (gaussians_first) pass->draw(list, camera, projection(), options, statistics);
    return read();
  }

  std::unique_ptr<GaussianPass> gaussians;
};

}  // namespace

TEST_CASE("blends Gaussians and volumes of one place by depth with OpenGL, as on the processor") {
  const RenderList list = haze_with_gaussians(200);
  for (const int samples : {1, 4}) {
    Picture picture(samples);
    const Pixels wanted = picture.drawn(list, SplatPath::cpu);
    CHECK(picture.statistics.splats == std::string("cpu"));
    const std::size_t vectors = picture.statistics.vectors;
    const Pixels drawn = picture.drawn(list, SplatPath::gl);
    CHECK(picture.statistics.splats == std::string("gl"));
    CHECK(static_cast<double>(picture.statistics.vectors) == Approx(static_cast<double>(vectors)).epsilon(0.01));
    const Pixels exact = picture.drawn(list, SplatPath::cpu, 300);
    const double own = psnr_of(drawn, exact), eight = psnr_of(picture.drawn(list, SplatPath::gl, 8), exact),
                 behind = psnr_of(picture.ordered(list, true), exact),
                 before = psnr_of(picture.ordered(list, false), exact);
    INFO(samples << " samples: " << psnr_of(drawn, wanted) << " dB against the processor; against an exact picture "
                 << own << " dB, with 8 slabs " << eight << " dB, Gaussians behind the volume " << behind
                 << " dB, in front " << before << " dB");
    CHECK(psnr_of(drawn, wanted) > 45);
    CHECK(eight > 41);
    CHECK(own > behind + 5);
    CHECK(own > before + 4);
  }
}

TEST_CASE("finds the depths that Gaussians and volumes share, and fewer slabs for a small part of the picture") {
  RenderList list = haze_with_gaussians(0);
  qnv::Gaussians gaussians = random_gaussians(3, 0, 1);
  gaussians.positions = {{0, 0, 0.5f}, {0.9f, 0, -0.25f}, {0, 0, 3}};
  gaussians.description.box.add(glm::vec3(-1));
  gaussians.description.box.add(glm::vec3(1, 1, 3));
  list.splats[1].geometry = std::make_shared<const qnv::Geometry>(gaussians);
  Camera camera;
  camera.world_from_camera = glm::translate(glm::dmat4(1), {0, 0, 5});
  SplatView view;
  view.width = view.height = 600;
  view.tangents = {0.5f, 0.5f};
  view.near_plane = 0.1f;
  const auto shared = [&] {
    GaussianItem item;
    item.gaussians = &gaussians;
    item.count = gaussians.size();
    item.camera_from_node = glm::mat4(camera_from_world_of(camera) * list.splats[1].world_from_node);
    return shared_depths({&item, 1}, volume_boxes(list, camera), view);
  };
  CHECK(do_boxes_of_gaussians_and_volumes_overlap(list));
  auto found = shared();
  REQUIRE(found);
  CHECK(found->range.nearest == Approx(4.5));
  CHECK(found->range.farthest == Approx(5.25));
  CHECK(found->slabs == 7);  // 103 pixels
  view.width = view.height = 60;
  CHECK(shared()->slabs == 1);
  view.width = view.height = 6000;
  CHECK(shared()->slabs == kSlabs);
  view.tangents = {0.1f, 0.1f};  // the second one is out of view
  CHECK(shared()->range.farthest == Approx(4.5));
  CHECK(shared()->slabs == 1);
  camera.world_from_camera = glm::translate(glm::dmat4(1), {0, 0, -9});  // looks away
  CHECK_FALSE(shared());
  camera.world_from_camera = glm::translate(glm::dmat4(1), {0, 0, 5});
  list.splats[1].world_from_node = translation({0, 0, 1.5f});  // the boxes overlap, but no Gaussian is inside
  gaussians.positions[1].z = 0;
  CHECK(do_boxes_of_gaussians_and_volumes_overlap(list));
  CHECK_FALSE(shared());
  list.splats[1].world_from_node = translation({2.5, 0, 0});
  CHECK_FALSE(do_boxes_of_gaussians_and_volumes_overlap(list));
  list.splats.pop_back();
  CHECK_FALSE(do_boxes_of_gaussians_and_volumes_overlap(list));
  CHECK_FALSE(shared_depths({}, volume_boxes(list, camera), view));
}

TEST_CASE("does not draw volumes and Gaussians together if only the boxes of all of them overlap") {
  RenderList list = haze_with_gaussians(20);
  list.splats[1].world_from_node = translation({4, 0, 0});
  SplatItem other = list.splats[1];
  other.world_from_node = translation({-4, 0, 0});
  list.splats.push_back(other);
  CHECK_FALSE(do_boxes_of_gaussians_and_volumes_overlap(list));
}

TEST_CASE("cuts a stream of Gaussians once per picture if only its box overlaps a volume") {
  RenderList list = haze_with_gaussians(20);
  const auto encoded = qnv::encode_gaussians(splat_cloud(6000), {});
  auto opened = qnv::SplatStream::open(std::get<qnv::EncodedStream>(encoded).bytes);
  qnv::Gaussians gaussians;
  gaussians.stream = std::get<std::unique_ptr<qnv::SplatStream>>(std::move(opened));
  qnv::SplatStream& stream = *gaussians.stream;
  gaussians.description.box = stream.box();
  for (const float corner : {-8.0f, 8.0f}) gaussians.description.box.add(glm::vec3(corner));
  list.splats[1].geometry = std::make_shared<const qnv::Geometry>(std::move(gaussians));
  list.splats[1].world_from_node = translation({2, 0, -4});
  REQUIRE(do_boxes_of_gaussians_and_volumes_overlap(list));
  Picture picture(1);
  picture.options.splats = SplatPath::cpu;
  picture.options.most_decoded = 4000;
  picture.options.time = 1;
  std::size_t cached = 0;
  for (int frame = 0; frame < 3; ++frame) {
    picture.statistics = {};
    CHECK_FALSE(
        picture.gaussians->overlap(list, picture.camera, picture.projection(), picture.options, picture.statistics));
    CHECK(stream.statistics().cached_splats > cached);
    cached = stream.statistics().cached_splats;
    picture.gaussians->draw(list, picture.camera, picture.projection(), picture.options, picture.statistics);
    CHECK(stream.statistics().cached_splats == cached);
    CHECK(picture.statistics.gaussians > 0);
    CHECK(picture.statistics.pending);
  }
}

TEST_CASE("divides hostile Gaussians and volumes into slabs") {
  const qnv::Gaussians gaussians = hostile_gaussians();
  GaussianItem item;
  item.gaussians = &gaussians;
  item.count = gaussians.size();
  item.first = 5;
  Box box;
  box.add(glm::vec3(-1e30f));
  box.add(glm::vec3(1e30f));
  SplatView view;
  view.width = view.height = 100;
  view.tangents = {1, 1};
  for (const float scale : {0.0f, 1.0f, std::numeric_limits<float>::quiet_NaN(), 1e30f}) {
    const VolumeBox volume{box, glm::scale(glm::mat4(1.0f), glm::vec3(scale))};
    const auto shared = shared_depths({&item, 1}, {&volume, 1}, view);
    CHECK((!shared || (shared->slabs <= kSlabs && shared->range.nearest <= shared->range.farthest)));
  }
}

}  // namespace gs::render::gaussian_overlap_test
