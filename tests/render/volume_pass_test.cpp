#include "render/volume_pass.h"

#include "tests/render/clouds.h"
#include "tests/render/drawing.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

using namespace gs;
using namespace gs::render;
using gs::test::random_volume;

namespace {

constexpr int kWidth = 80, kHeight = 60;
using Pixels = std::vector<std::uint8_t>;

/// A target of a known colour and depth on OSMesa, and a pass that draws into it.
class Target {
 public:
  Target() {
    auto opened = open_headless_context("osmesa");
    if (auto* error = std::get_if<ContextError>(&opened)) FAIL(error->message);
    context_ = std::move(std::get<std::unique_ptr<GlContext>>(opened));
    auto loaded = Gl::load(*context_);
    if (auto* error = std::get_if<ContextError>(&loaded)) FAIL(error->message);
    gl_ = std::move(std::get<Gl>(loaded));
    framebuffer_ = make_framebuffer(gl_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    color_ = attach(GL_RGBA8, GL_COLOR_ATTACHMENT0);
    depth_ = attach(GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    REQUIRE(gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
    pass = std::make_unique<VolumePass>(gl_);
    camera.world_from_camera = testing::translation({0, 0, 3});
    camera.near_plane = 0.1f;
    camera.far_plane = 10;
    options.width = kWidth;
    options.height = kHeight;
  }

  /// RGB after the pass, where something of `color` has stood at `depth` (camera units) in all pixels.
  Pixels draw(const RenderList& list, const glm::vec3& color, float depth) {
    const glm::mat4 clip_from_camera = projection(camera, kWidth, kHeight);
    const glm::vec4 clip = clip_from_camera * glm::vec4(0, 0, -depth, 1);
    const float background[4] = {color.x, color.y, color.z, 1}, far = clip.z / clip.w * 0.5f + 0.5f;
    gl_.Viewport(0, 0, kWidth, kHeight);
    gl_.DepthMask(GL_TRUE);
    gl_.ClearBufferfv(GL_COLOR, 0, background);
    gl_.ClearBufferfv(GL_DEPTH, 0, &far);
    statistics = {};
    pass->draw(list, camera, clip_from_camera, options, statistics);
    Pixels pixels(std::size_t{kWidth} * kHeight * 4);
    gl_.ReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    CHECK(gl_.GetError() == GL_NO_ERROR);
    return pixels;
  }

  std::unique_ptr<VolumePass> pass;
  Camera camera;
  DrawOptions options;
  FrameStatistics statistics;

 private:
  Renderbuffer attach(GLenum format, GLenum attachment) {
    Renderbuffer buffer = make_renderbuffer(gl_);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, buffer.name());
    gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, format, kWidth, kHeight);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.name());
    return buffer;
  }

  std::unique_ptr<GlContext> context_;
  Gl gl_;
  Framebuffer framebuffer_;
  Renderbuffer color_, depth_;
};

RenderList list_of(const std::shared_ptr<const qnv::Cloud>& cloud) {
  RenderList list;
  SplatItem item;
  item.cloud = cloud;
  list.splats.push_back(item);
  return list;
}

bool plain(const Pixels& pixels, const glm::vec3& color) {
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (i % 4 < 3 && std::abs(pixels[i] - color[static_cast<int>(i % 4)] * 255) > 1) return false;
  return true;
}

}  // namespace

TEST_CASE("A volume is blended over what was drawn, pixel by pixel") {
  Target target;
  const auto cloud = std::make_shared<const qnv::Cloud>(random_volume(900, 5, 0.12f));
  const Pixels drawn = target.draw(list_of(cloud), {0.2f, 0.4f, 0.8f}, 9);
  CHECK(target.statistics.vectors == 900);
  CHECK(target.statistics.draw_calls == 1);
  SplatView view;
  view.camera_from_node = testing::translation({0, 0, -3});
  const glm::mat4 clip_from_camera = projection(target.camera, kWidth, kHeight);
  view.tangents = {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]};
  view.width = kWidth;
  view.height = kHeight;
  view.near_plane = 0.1f;
  const VolumeLayer layer = rasterize_volume(*cloud, volume_model(*cloud), view, {});
  REQUIRE(layer.pixels.size() == drawn.size());
  const std::array<float, 3> under = {0.2f * 255, 0.4f * 255, 0.8f * 255};
  float furthest = 0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (i % 4 == 3) continue;
    const float clear = 1 - layer.pixels[i - i % 4 + 3] / 255.0f;
    furthest = std::max(furthest, std::abs(drawn[i] - (layer.pixels[i] + clear * under[i % 4])));
  }
  CHECK(furthest <= 1.6f);
}

TEST_CASE("A polygon in front of a volume hides it, one behind does not") {
  Target target;
  const auto cloud = std::make_shared<const qnv::Cloud>(random_volume(900, 5, 0.12f));
  const glm::vec3 color(0, 0, 1);
  CHECK(plain(target.draw(list_of(cloud), color, 1), color));
  CHECK(!plain(target.draw(list_of(cloud), color, 5), color));
}

TEST_CASE("Surfaces, empty volumes and volumes behind the camera are left alone") {
  Target target;
  const glm::vec3 color(0.6f, 0, 0);
  qnv::Cloud surface = random_volume(50, 1, 0.1f);
  surface.description.kind = qnv::Kind::surface;
  CHECK(plain(target.draw(list_of(std::make_shared<const qnv::Cloud>(surface)), color, 9), color));
  CHECK(target.statistics.vectors == 0);
  qnv::Cloud nothing;
  nothing.description.kind = qnv::Kind::volume;
  CHECK(plain(target.draw(list_of(std::make_shared<const qnv::Cloud>(nothing)), color, 9), color));
  RenderList list = list_of(std::make_shared<const qnv::Cloud>(random_volume(50, 1, 0.1f)));
  list.splats[0].world_from_node = testing::translation({0, 0, 30});
  CHECK(plain(target.draw(list, color, 9), color));
}

TEST_CASE("Transparency, clipping plane and threshold of a volume") {
  Target target;
  const glm::vec3 color(0, 0, 0.5f);
  RenderList list = list_of(std::make_shared<const qnv::Cloud>(random_volume(900, 5, 0.12f)));
  list.splats[0].material.transparency = 1;
  CHECK(plain(target.draw(list, color, 9), color));
  list.splats[0].material.transparency = 0;
  target.pass->settings.least_magnitude = 2;
  CHECK(plain(target.draw(list, color, 9), color));
  target.pass->settings.least_magnitude = 0;
  list.splats[0].world_from_node = testing::translation({0, 0, -1});
  target.pass->settings.clip = glm::vec4(0, 0, 1, -0.1f);  // the world's z >= 0.1: in front of all of it
  CHECK(plain(target.draw(list, color, 9), color));
  target.pass->settings.clip = glm::vec4(0, 0, 1, 1);
  (void)target.draw(list, color, 9);
  CHECK(target.statistics.vectors > 300);
  CHECK(target.statistics.vectors < 600);
}

TEST_CASE("Of two volumes the nearer one is drawn over the other") {
  Target target;
  const auto of_color = [](qnv::Rgb8 color) {
    auto cloud = std::make_shared<qnv::Cloud>(random_volume(4000, 3, 0.05f));
    cloud->description.transfer = {{0, color, 0.99f}, {1, color, 0.99f}};
    return cloud;
  };
  RenderList list = list_of(of_color({255, 0, 0}));
  list.splats.push_back(list.splats[0]);
  list.splats[0].cloud = of_color({0, 255, 0});
  list.splats[1].world_from_node = testing::translation({0, 0, -3});
  target.options.headlight = true;
  for (int turn = 0; turn < 2; ++turn) {
    const Pixels drawn = target.draw(list, {0, 0, 0}, 9);
    const std::uint8_t* middle = drawn.data() + 4 * (kHeight / 2 * kWidth + kWidth / 2);
    CHECK(middle[1] > 80);
    CHECK(middle[0] < middle[1] / 2);
    std::swap(list.splats[0], list.splats[1]);
  }
}

TEST_CASE("The lights of a volume: its directional ones, the strongest others, the headlight") {
  RenderList list;
  for (int i = 0; i < 7; ++i) {
    Light light;
    light.kind = i < 2 ? Light::Kind::directional : Light::Kind::point;
    light.intensity = 0.1f * static_cast<float>(i);
    light.ambient_intensity = 0.05f;
    list.lights.push_back(light);
  }
  list.lights[1].direction = {0, -1, 0};
  SplatItem item;
  item.directional_lights = {1, 99};
  const auto lights = volume_lights(list, item, glm::mat4(1), {0, 0, -3}, true);
  REQUIRE(lights.size() == 5);
  CHECK(lights[0].directional);
  CHECK(lights[0].place == glm::vec3(0, 1, 0));
  CHECK(lights[0].ambient == Approx(0.5f));
  CHECK(lights[1].color.x == Approx(0.6f));
  CHECK(lights[3].color.x == Approx(0.4f));
  CHECK(lights[4].directional);
  CHECK(lights[4].place == glm::vec3(0, 0, 1));
  const auto none = volume_lights({}, item, glm::mat4(1), {0, 0, -3}, false);
  REQUIRE(none.size() == 1);
  CHECK(none[0].color == glm::vec3(0));
}
