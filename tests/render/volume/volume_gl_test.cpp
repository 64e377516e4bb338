#include "render/volume/volume_gl.h"

#include "render/sorting/depth_sort_shaders.h"
#include "render/volume/volume_shaders.h"

#include "tests/render/volume_scenes.h"

#include <array>
#include <limits>
#include <string>

using namespace gs;
using namespace gs::test;
using namespace gs::render;
using testing::scale;
using testing::translation;

namespace {

const glm::vec3 kBlue(0.2f, 0.4f, 0.8f);
const Pixels kUnderBlue{51, 102, 204, 255};

std::shared_ptr<const qnv::Volume> shell(std::size_t count = 900, unsigned seed = 5, float spacing = 0.12f) {
  return std::make_shared<const qnv::Volume>(random_volume(count, seed, spacing));
}

/// Compares OpenGL, with both sorts, and the processor, and returns the processor's picture. `least` is in decibels.
Pixels check_same(const RenderList& list, const DrawOptions& look, const glm::vec3& eye = {0, 0, 3}, int samples = 1,
                  double least = 40) {
  Pixels wanted;
  for (const SortMethod sort : {SortMethod::thread, SortMethod::compute}) {
    VolumePicture picture(sort, 80, 60, samples);
    picture.camera.world_from_camera = glm::inverse(glm::lookAt(eye, glm::vec3(0), glm::vec3(0.1f, 1, 0.05f)));
    picture.options.splat_style = look.splat_style;
    picture.options.budget = look.budget;
    if (wanted.empty()) {
      wanted = picture.draw(list, kBlue, 25);
      CHECK(picture.statistics.splats == std::string("cpu"));
    }
    const std::size_t vectors = [&] {
      (void)picture.draw(list, kBlue, 25);
      return picture.statistics.vectors;
    }();
    picture.options.splats = SplatPath::gl;
    const Pixels drawn = picture.draw(list, kBlue, 25);
    CHECK(picture.statistics.splats == std::string("gl"));
    CHECK(picture.statistics.vectors == vectors);
    CHECK(!picture.statistics.pending);
    CHECK(picture.pass->sorted_by() == (picture.gl.DispatchCompute ? sort : SortMethod::thread));
    CHECK(!plain(drawn, kBlue));
    const double psnr = psnr_of(drawn, wanted);
    INFO("PSNR " << psnr << " sorted by " << static_cast<int>(sort));
    CHECK(psnr >= least);
  }
  return wanted;
}

}  // namespace

TEST_CASE("draws a volume with OpenGL as on the processor and by the ray caster", "[optimised]") {
  const auto geometry = shell();
  for (const glm::vec3& eye : {glm::vec3(0, 0, 3), glm::vec3(3, 1, -1), glm::vec3(0.9f, 0.2f, 0.3f)}) {
    for (const SortMethod sort : {SortMethod::thread, SortMethod::compute}) {
      VolumePicture picture(sort);
      picture.camera.world_from_camera = glm::inverse(glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 1, 0)));
      const RayImage exact = raycast_volume(*geometry, picture.view(), {});
      for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
        picture.options.splats = path;
        const double psnr = psnr_over(picture.draw(volume_list(geometry), kBlue, 25), exact, kUnderBlue);
        INFO("PSNR " << psnr << " path " << static_cast<int>(path) << " sort " << static_cast<int>(sort));
        CHECK(psnr >= 40);
      }
    }
  }
}

TEST_CASE("draws many small and few large vectors with OpenGL as on the processor", "[optimised]") {
  (void)check_same(volume_list(shell(30'000, 7, 0.02f)), {});
  (void)check_same(volume_list(shell(20, 8, 0.4f)), {});
  (void)check_same(volume_list(shell(1, 9, 0.4f)), {});
  // The vectors are smaller than a pixel.
  (void)check_same(volume_list(shell(3000, 9, 0.01f)), {}, {0, 0, 20});
}

TEST_CASE("draws lights, threshold, clipping plane, transparency and slant with OpenGL as on the processor") {
  RenderList list =
      volume_list(shell(700, 6, 0.15f), glm::mat4(glm::vec4(1.2f, 0.3f, 0, 0), glm::vec4(0, 0.7f, 0.2f, 0),
                                                  glm::vec4(0, 0, -1, 0), glm::vec4(0.1f, 0, 0, 1)));
  DrawOptions look;
  look.splat_style.least_magnitude = 0.4f;
  look.splat_style.clip = glm::vec4(0.5f, 0.5f, 0, 0.1f);
  (void)check_same(list, look);
  Light sun, lamp, spot;
  sun.direction = glm::vec3(-0.6f, -0.8f, 0);
  sun.color = {1, 0.5f, 0.2f};
  lamp.kind = Light::Kind::point;
  lamp.location = {0, 1, 2};
  lamp.attenuation = {1, 0.2f, 0};
  lamp.radius = 9;
  spot.kind = Light::Kind::spot;
  spot.location = {0, 0, 3};
  spot.beam_width = 0.1f;
  spot.cut_off_angle = 0.3f;
  list.lights = {sun, lamp, spot};
  list.splats[0].directional_lights = {0};
  list.splats[0].material.transparency = 0.5f;
  (void)check_same(list, look);
  look.splat_style.opacity = 20;
  look.splat_style.transfer = {{0, {255, 0, 0}, 0.1f}, {1, {0, 255, 0}, 0.9f}};
  (void)check_same(list, look);
}

TEST_CASE("draws distinguishing and stored colours with OpenGL as on the processor") {
  auto geometry = std::make_shared<qnv::Volume>(random_volume(9000, 4, 0.06f));
  DrawOptions look;
  const Pixels own = check_same(volume_list(geometry), look);
  for (const ColorBy by : {ColorBy::normal, ColorBy::level, ColorBy::chunk, ColorBy::age}) {
    look.splat_style.color_by = by;
    INFO(static_cast<int>(by));
    CHECK(psnr_of(check_same(volume_list(geometry), look), own) < 30);
  }
  geometry->classes.clear();
  for (std::size_t i = 0; i < geometry->size(); ++i)
    geometry->colors.push_back({static_cast<std::uint8_t>(i % 251), 90, 7});
  (void)check_same(volume_list(geometry), {});
}

TEST_CASE("draws nested, transformed volumes with OpenGL as on the processor") {
  RenderList list = volume_list(shell(900, 5));
  list.splats.push_back(volume_list(shell(800, 12), translation({0.4f, 0.2f, 0.5f})).splats[0]);
  SplatItem again = list.splats[0];
  again.world_from_node = translation({-0.5f, 0, 0});
  list.splats.push_back(again);
  list.splats.push_back(volume_list(shell(50, 13), scale({0, 1, 1})).splats[0]);  // a flat volume is not drawn
  (void)check_same(list, {});
  for (int i = 0; i < 40; ++i)
    list.splats.push_back(
        volume_list(shell(20, static_cast<unsigned>(i)), translation({0.05f * static_cast<float>(i) - 1, 0, 0}))
            .splats[0]);
  (void)check_same(list, {});
}

TEST_CASE("draws within a budget with OpenGL as on the processor") {
  DrawOptions look;
  look.budget = 300;
  (void)check_same(volume_list(shell(5000, 3, 0.05f)), look);
}

TEST_CASE("hides the volume behind a polygon and veils the polygon by the volume before it, with OpenGL") {
  const auto geometry = shell(2000, 5, 0.1f);
  const std::array<glm::vec3, 4> slanted{
      {{-0.6f, -0.7f, -2.6f}, {0.7f, -0.6f, -3}, {-0.7f, 0.6f, -3}, {0.6f, 0.7f, -3.4f}}};
  for (const int samples : {1, 4}) {
    Pixels wanted;
    for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
      VolumePicture picture(SortMethod::automatic, 80, 60, samples);
      picture.options.splats = path;
      picture.clear(kBlue, 25);
      picture.polygon(slanted, {0.9f, 0.9f, 0});
      picture.volumes(volume_list(geometry));
      const Pixels drawn = picture.read();
      if (path == SplatPath::cpu) wanted = drawn;
      const double psnr = psnr_of(drawn, wanted);
      INFO("PSNR " << psnr << " samples " << samples);
      CHECK(psnr >= 40);
    }
  }
}

TEST_CASE("sorts for OpenGL at most one picture late, and exactly for an unchanged view", "[optimised]") {
  VolumePicture picture(SortMethod::thread), fresh(SortMethod::thread);
  picture.options.splats = fresh.options.splats = SplatPath::gl;
  const RenderList list = volume_list(shell(30'000, 7, 0.03f));
  (void)picture.draw(list, kBlue, 25);
  CHECK(!picture.statistics.pending);
  for (int frame = 0; frame < 5; ++frame) {
    const glm::vec3 eye(std::sin(0.02f * static_cast<float>(frame)) * 3, 0,
                        std::cos(0.02f * static_cast<float>(frame)) * 3);
    picture.camera.world_from_camera = glm::inverse(glm::lookAt(eye, glm::vec3(0), glm::vec3(0, 1, 0)));
    fresh.camera = picture.camera;
    const Pixels wanted = fresh.draw(list, kBlue, 25);
    CHECK(psnr_of(picture.draw(list, kBlue, 25), wanted) >= 40);
    const Pixels again = picture.draw(list, kBlue, 25);
    CHECK(!picture.statistics.pending);
    CHECK(psnr_of(again, fresh.draw(list, kBlue, 25)) > 100);
  }
  // Another viewport has its own order.
  picture.options.viewport = 1;
  picture.camera.world_from_camera = glm::inverse(glm::lookAt(glm::vec3(0, 0, -3), glm::vec3(0), glm::vec3(0, 1, 0)));
  fresh.camera = picture.camera;
  const Pixels behind = picture.draw(list, kBlue, 25);
  CHECK(!picture.statistics.pending);
  CHECK(psnr_of(behind, fresh.draw(list, kBlue, 25)) > 100);
  for (std::uint32_t viewport = 0; viewport < 40; ++viewport) {
    picture.options.viewport = viewport;
    CHECK(psnr_of(picture.draw(list, kBlue, 25), behind) > 40);
  }
}

TEST_CASE("sorts in compute shaders like the sorting thread", "[optimised]") {
  VolumePicture picture;
  if (!picture.gl.DispatchCompute) {
    WARN("no compute shaders here");
    return;
  }
  const auto get = reinterpret_cast<PFNGLGETBUFFERSUBDATAPROC>(picture.context->proc_address("glGetBufferSubData"));
  REQUIRE(get);
  VolumeStore store(picture.gl);
  const auto sort = DepthGlSort::create(
      picture.gl, std::string("#define ITEM_TEXELS 16\n#define MOST_LIGHTS 0\n") + kVolumeItemShader + kItemsShader +
                      kVolumeDataShader + kVolumeKeysShader);
  REQUIRE(sort);
  const Buffer order = make_buffer(picture.gl), item_buffer = make_buffer(picture.gl);
  const Texture items = make_texture(picture.gl);
  // The vectors have one depth, all depths, or many of them one depth.
  for (const std::size_t count : {1u, 2u, 255u, 4096u, 4097u, 70'000u}) {
    for (const float deep : {0.0f, 1.0f}) {
      auto geometry = std::make_shared<qnv::Volume>(random_volume(count, 3, 0.1f));
      for (std::size_t k = 0; k<count; k += deep> 0 ? 3 : 1) geometry->positions[k].z = 0.25f;
      const auto model = std::make_shared<const VolumeModel>(volume_model(*geometry));
      const SharedVolume held{geometry, model};
      const auto places = store.place(std::span(&held, 1));
      REQUIRE(places.size() == 1);
      std::vector<glm::vec4> texels(16, glm::vec4(0));
      texels[2] = {0, 0, 1, -3};  // the row of z: depth = 3 - z
      texels[6] = glm::vec4(places[0].coding.lower, 0);
      texels[7] = glm::vec4(places[0].coding.step, 0);
      texels[8] = {0, 0, static_cast<float>(places[0].first >> 16), static_cast<float>(places[0].first & 0xFFFF)};
      picture.gl.BindBuffer(GL_TEXTURE_BUFFER, item_buffer.name());
      picture.gl.BufferData(GL_TEXTURE_BUFFER, 256, texels.data(), GL_STATIC_DRAW);
      picture.gl.BindTexture(GL_TEXTURE_BUFFER, items.name());
      picture.gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, item_buffer.name());
      REQUIRE(sort->sort({store.codes().name(), items.name(), 1}, count, order));
      std::vector<std::uint32_t> sorted(count);
      picture.gl.BindBuffer(GL_ARRAY_BUFFER, order.name());
      get(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(count * 4), sorted.data());
      std::vector<VolumeCode> codes(count);
      encode_volume_codes(*geometry, places[0].coding, 0, codes);
      std::size_t wrong = 0;
      std::vector<bool> seen(count);
      for (std::size_t i = 0; i < count; ++i) {
        REQUIRE(sorted[i] < count);
        REQUIRE(!seen[sorted[i]]);
        seen[sorted[i]] = true;
        if (i == 0) continue;
        const std::uint32_t a = codes[sorted[i - 1]][2] & 0xFFFFF, b = codes[sorted[i]][2] & 0xFFFFF;
        // Codes one step apart may round to one depth.
        if (a > b + 1 || (a == b && sorted[i - 1] < sorted[i])) ++wrong;
      }
      INFO(count << " vectors");
      CHECK(wrong == 0);
    }
  }
  CHECK(!sort->sort({store.codes().name(), items.name(), 1}, 0, order));
  CHECK(picture.gl.GetError() == GL_NO_ERROR);
}

TEST_CASE("survives volumes of any numbers with OpenGL") {
  constexpr std::array<float, 9> numbers = {kNaN, kInfinity, -kInfinity, 0, -1, 1e38f, -1e38f, 1e-38f, 3e9f};
  VolumePicture picture(SortMethod::compute, 24, 24);
  picture.options.splats = SplatPath::gl;
  std::mt19937 random(9);
  const auto any = [&] { return numbers[random() % numbers.size()]; };
  for (int round = 0; round < 60; ++round) {
    qnv::Volume geometry = random_volume(1 + static_cast<std::size_t>(round), 4, 0.2f);
    for (std::size_t i = 0; i < geometry.size(); i += 2) {
      if (round % 3 != 0) geometry.positions[i] = {any(), any(), any()};
      geometry.normals[i] = {any(), any(), any()};
      geometry.weights[i] = any();
    }
    if (round % 4 == 1) geometry.description.transfer[1].value = geometry.description.transfer[2].opacity = any();
    if (round % 5 == 1) geometry.classes.clear();
    RenderList list = volume_list(std::make_shared<const qnv::Volume>(geometry));
    if (round % 6 == 1) list.splats[0].world_from_node[1][1] = any();
    if (round % 6 == 2) list.splats[0].world_from_node[3][2] = any();
    picture.options.splat_style = {};
    if (round % 7 == 1) picture.options.splat_style.opacity = any();
    if (round % 7 == 2) picture.options.splat_style.clip = glm::vec4(any(), any(), any(), any());
    if (round % 7 == 3) picture.options.splat_style.least_magnitude = any();
    picture.options.budget = round % 3 == 1 ? 10 : 0;
    (void)picture.draw(list, kBlue, 25);
    (void)picture.draw(list, kBlue, 25);
  }
}

TEST_CASE("draws volumes on the processor that OpenGL cannot draw") {
  VolumePicture picture(SortMethod::thread);
  VolumeGl volumes(picture.gl);
  const auto geometry = shell();
  const auto model = std::make_shared<const VolumeModel>(volume_model(*geometry));
  const SharedVolume held{geometry, model};
  VolumeItem item{geometry.get(), model.get(), glm::inverse(picture.camera.world_from_camera), geometry->size(), {}};
  const VolumeGl::View view{picture.view(), picture.projection(), {0, 0, 80, 60}, 0};
  picture.clear(kBlue, 25);
  CHECK(volumes.prepare(std::span(&held, 1), std::span(&item, 1), view).has_value());
  const std::vector<VolumeLight> lights(40);
  item.options.lights = lights;
  CHECK(!volumes.prepare(std::span(&held, 1), std::span(&item, 1), view));
  item.options.lights = {};
  item.camera_from_node[0][0] = kNaN;
  const auto nothing = volumes.prepare(std::span(&held, 1), std::span(&item, 1), view);
  REQUIRE(nothing);
  CHECK(nothing->found.vectors == 0);
  CHECK(nothing->total == 0);
}
