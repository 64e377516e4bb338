#include "render/gaussians/gaussian_gl.h"

#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "render/gaussians/gaussian_overlap.h"
#include "render/gaussians/gaussian_pass.h"
#include "tests/qnv/splat_clouds.h"
#include "tests/render/gaussians/gaussian_scenes.h"
#include "tests/render/volume_scenes.h"

#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <string>
#include <utility>
#include <variant>

namespace gs::render::gaussian_gl_test {

using namespace test;
using testing::scale;
using testing::translation;

namespace {

const glm::vec3 kSky(0.2f, 0.4f, 0.8f);

std::shared_ptr<const qnv::Gaussians> scene(std::size_t count, int degree, std::uint32_t seed) {
  return std::make_shared<const qnv::Gaussians>(random_gaussians(count, degree, seed));
}

RenderList list_of(const std::shared_ptr<const qnv::Gaussians>& gaussians,
                   const glm::mat4& world_from_node = glm::mat4(1.0f)) {
  RenderList list;
  SplatItem item;
  item.geometry = shared_geometry(gaussians);
  item.world_from_node = world_from_node;
  list.splats.push_back(item);
  return list;
}

/// Framebuffer with known colour and depth, and a pass that draws Gaussians into it.
class Picture : public VolumePicture {
 public:
  explicit Picture(SortMethod sort, int samples = 1, int width = 80, int height = 60)
      : VolumePicture(SortMethod::thread, width, height, samples) {
    gaussians = std::make_unique<GaussianPass>(gl, sort);
  }
  ~Picture() {
    context->make_current();
    gaussians = nullptr;
  }
  void look(const glm::vec3& eye, const glm::vec3& at = glm::vec3(0)) {
    camera.world_from_camera = glm::inverse(glm::lookAt(eye, at, glm::vec3(0.1f, 1, 0.05f)));
  }
  /// Draws Gaussians by a path. `before` draws polygons.
  template <class Before>
  Pixels drawn(const RenderList& list, SplatPath path, const Before& before) {
    clear(kSky, 25);
    before();
    options.splats = path;
    statistics = {};
    gaussians->draw(list, camera, projection(), options, statistics);
    return read();
  }
  Pixels drawn(const RenderList& list, SplatPath path) {
    return drawn(list, path, [] {});
  }

  std::unique_ptr<GaussianPass> gaussians;
};

/// Compares OpenGL, with both sorts, with the processor.
template <class Before>
void check_same(const RenderList& list, const DrawOptions& look, const glm::vec3& eye, int samples,
                const Before& before) {
  for (const SortMethod sort : {SortMethod::thread, SortMethod::compute}) {
    Picture picture(sort, samples);
    picture.look(eye);
    picture.options.splat_style = look.splat_style;
    const auto polygons = [&] { before(picture); };
    const Pixels wanted = picture.drawn(list, SplatPath::cpu, polygons);
    CHECK(picture.statistics.splats == std::string("cpu"));
    const std::size_t vectors = picture.statistics.vectors;
    const Pixels drawn = picture.drawn(list, SplatPath::gl, polygons);
    CHECK(picture.statistics.splats == std::string("gl"));
    CHECK(static_cast<double>(picture.statistics.vectors) == Approx(static_cast<double>(vectors)).epsilon(0.01));
    CHECK(!picture.statistics.pending);
    CHECK(picture.gaussians->sorted_by() == (picture.gl.DispatchCompute ? sort : SortMethod::thread));
    CHECK(!plain(drawn, kSky));
    const double psnr = psnr_of(drawn, wanted);
    INFO("PSNR " << psnr << " sorted by " << static_cast<int>(sort) << ", " << samples << " samples");
    CHECK(psnr >= 45);
  }
}
void check_same(const RenderList& list, const glm::vec3& eye = {0, 0, 3}, int samples = 1) {
  check_same(list, {}, eye, samples, [](Picture&) {});
}

}  // namespace

TEST_CASE("draws Gaussians with OpenGL as on the processor, from any direction") {
  for (const int degree : {0, 1, 2, 3})
    for (const glm::vec3& eye : {glm::vec3(0, 0, 3), glm::vec3(2, 1, -1), glm::vec3(0.3f, 0.2f, 0.4f)}) {
      INFO("degree " << degree << " from " << eye.x);
      check_same(list_of(scene(400, degree, 7)), eye);
    }
}

TEST_CASE("draws a Gaussian with its own opacity, whatever the factor of volumes") {
  for (const float opacity : {0.02f, 0.3f, 0.6f, 0.9f}) {
    qnv::Gaussians one = random_gaussians(1, 0, 1);
    one.positions[0] = glm::vec3(0);
    one.scales[0] = glm::vec3(0.5f);  // about 11 pixels
    one.opacities[0] = opacity;
    one.bases[0] = {1, 0.5f, 0};
    const RenderList list = list_of(std::make_shared<const qnv::Gaussians>(one));
    for (const float factor : {SplatStyle{}.opacity, 0.1f}) {
      Picture picture(SortMethod::thread);
      picture.look({0, 0, 3});
      picture.options.splat_style.opacity = factor;
      for (const SplatPath path : {SplatPath::cpu, SplatPath::gl}) {
        const Pixels drawn = picture.drawn(list, path);
        const std::uint8_t* const middle = drawn.data() + 4 * (30 * 80 + 40);
        for (int k = 0; k < 3; ++k) {
          const float wanted = kSky[k] + (one.bases[0][k] - kSky[k]) * opacity;
          CHECK(static_cast<float>(middle[k]) == Approx(255 * wanted).margin(2));
        }
      }
    }
  }
}

TEST_CASE("draws many small, few large and antialiased Gaussians with OpenGL as on the processor") {
  check_same(list_of(scene(20'000, 0, 3)), {0, 0, 9});
  check_same(list_of(scene(1, 3, 5)));
  check_same(list_of(scene(64, 1, 5)));
  qnv::Gaussians thin = random_gaussians(300, 0, 3);
  for (glm::vec3& size : thin.scales) size *= glm::vec3(4, 0.05f, 0.001f);
  check_same(list_of(std::make_shared<const qnv::Gaussians>(thin)));
  thin.antialiased = true;
  check_same(list_of(std::make_shared<const qnv::Gaussians>(thin)));
}

TEST_CASE("draws flat Gaussians with OpenGL as on the processor") {
  qnv::Gaussians flat = random_gaussians(400, 1, 9);
  for (std::size_t i = 0; i < flat.size(); ++i)
    if (i % 5 != 0) flat.scales[i].z = 0;
  const auto shared = std::make_shared<const qnv::Gaussians>(flat);
  for (const glm::vec3& eye : {glm::vec3(0, 0, 3), glm::vec3(2, 1, -1), glm::vec3(0.3f, 0.2f, 0.4f)})
    check_same(list_of(shared), eye);
  check_same(list_of(shared, glm::rotate(scale({1.5f, 0.6f, -1}), 1.0f, glm::vec3(1, 2, 3))), {0, 1, 4});
}

TEST_CASE("projects each Gaussian once with compute shaders, unless some are flat") {
  for (const SortMethod sort : {SortMethod::thread, SortMethod::compute})
    for (const bool flat : {false, true}) {
      qnv::Gaussians some = random_gaussians(300, 1, 5);
      for (glm::vec3& size : some.scales) size = glm::max(size, glm::vec3(0.01f));
      if (flat) some.scales[7].z = 0;
      const RenderList list = list_of(std::make_shared<const qnv::Gaussians>(some));
      Picture picture(sort);
      picture.look({0, 0, 3});
      const Pixels wanted = picture.drawn(list, SplatPath::cpu);
      const Pixels drawn = picture.drawn(list, SplatPath::gl);
      const bool computes = picture.gl.DispatchCompute && sort == SortMethod::compute;
      CHECK(picture.gaussians->projected_once() == (computes && !flat));
      CHECK(psnr_of(drawn, wanted) >= 45);
      // A larger scene needs a larger buffer.
      const RenderList more = list_of(scene(3000, 2, 8));
      const Pixels more_wanted = picture.drawn(more, SplatPath::cpu), more_drawn = picture.drawn(more, SplatPath::gl);
      CHECK(psnr_of(more_drawn, more_wanted) >= 45);
    }
}

TEST_CASE("draws several scenes of Gaussians in one order with OpenGL, clipped, faded, in fog and under any matrix") {
  RenderList list = list_of(scene(300, 2, 5), glm::rotate(scale({1.5f, 0.6f, -1}), 1.0f, glm::vec3(1, 2, 3)));
  list.splats.push_back(list_of(scene(200, 0, 6), translation({0.4f, 0.2f, 0.5f})).splats[0]);
  SplatItem again = list.splats[0];
  again.world_from_node = translation({-0.5f, 0, 0});
  again.material.transparency = 0.5f;
  list.splats.push_back(again);
  list.splats.push_back(list_of(scene(50, 0, 8), scale({0, 1, 1})).splats[0]);  // flat: not drawn
  check_same(list);
  list.fog.color = {1, 0.5f, 0};
  list.fog.visibility_range = 6;
  DrawOptions look;
  look.splat_style.clip = glm::vec4(0.5f, 0.5f, 0, 0.1f);
  look.splat_style.opacity = 0.7f;  // of volumes
  for (const bool exponential : {false, true}) {
    list.fog.exponential = exponential;
    check_same(list, look, {0, 0, 3}, 1, [](Picture&) {});
  }
}

TEST_CASE("draws Gaussians and volumes in the order of their distances from the eye") {
  qnv::Volume volume;
  volume.description.box.add(glm::vec3(-1));
  volume.description.box.add(glm::vec3(1));
  qnv::Gaussians gaussians = random_gaussians(3, 0, 1);
  gaussians.description.box.add(glm::vec3(-1));
  gaussians.description.box.add(glm::vec3(1));
  RenderList list = list_of(std::make_shared<const qnv::Gaussians>(gaussians), glm::mat4(translation({5, 0, 0})));
  CHECK_FALSE(are_gaussians_behind_volumes(list, {0, 0, 0}));  // there is no volume
  SplatItem item;
  item.geometry = std::make_shared<const qnv::Geometry>(volume);
  list.splats.push_back(item);
  CHECK(are_gaussians_behind_volumes(list, {-10, 0, 0}));
  CHECK(are_gaussians_behind_volumes(list, {0.5, 0, 0}));
  CHECK_FALSE(are_gaussians_behind_volumes(list, {10, 0, 0}));
  CHECK_FALSE(are_gaussians_behind_volumes(list, {4.5, 20, 0}));
  list.splats[0].world_from_node = translation({0.5f, 0, 0});  // overlaps the volume
  CHECK(are_gaussians_behind_volumes(list, {-10, 0, 0}));
  CHECK_FALSE(are_gaussians_behind_volumes(list, {10, 0, 0}));
  list.splats[0].world_from_node = translation({0, -5, 0});
  CHECK(are_gaussians_behind_volumes(list, {0, 10, 1}));
  CHECK_FALSE(are_gaussians_behind_volumes(list, {0, -10, 1}));
}

TEST_CASE("hides Gaussians behind polygons with OpenGL, and veils polygons by those in front, per sample") {
  const RenderList list = list_of(scene(600, 1, 9));
  const std::array<glm::vec3, 4> slanted{
      {{-0.6f, -0.7f, -2.6f}, {0.7f, -0.6f, -3}, {-0.7f, 0.6f, -3}, {0.6f, 0.7f, -3.4f}}};
  const std::array<glm::vec3, 4> near{{{0, -0.2f, -2}, {0.15f, -0.2f, -2}, {0.1f, 0.3f, -2}, {0.3f, 0.3f, -2}}};
  for (const int samples : {1, 4})
    check_same(list, {}, {0, 0, 3}, samples, [&](Picture& picture) {
      picture.polygon(slanted, {1, 1, 0});
      picture.polygon(near, {0, 1, 0});
    });
}

TEST_CASE(
    "composites Gaussians of the processor without depths if nothing opaque is drawn, with any number of samples") {
  const RenderList list = list_of(scene(60, 1, 9));
  for (const int samples : {1, 4}) {
    Picture picture(SortMethod::thread, samples);
    picture.look({0, 0, 9});
    const Pixels wanted = picture.drawn(list, SplatPath::cpu);
    picture.clear(kSky, 25);
    picture.gaussians->draw(list, picture.camera, picture.projection(), picture.options, picture.statistics, false);
    const Pixels drawn = picture.read();
    CHECK(drawn == wanted);
    CHECK(!plain(drawn, kSky));
    // A smaller part of the picture, which reuses the larger texture.
    picture.clear(kSky, 25);
    picture.options.x = 30;
    picture.options.width = 40;
    picture.options.height = 50;
    picture.gaussians->draw(list, picture.camera, picture.projection(), picture.options, picture.statistics, false);
    const Pixels part = picture.read();
    picture.clear(kSky, 25);
    picture.gaussians->draw(list, picture.camera, picture.projection(), picture.options, picture.statistics);
    CHECK(part == picture.read());
    CHECK(part != drawn);
  }
}

TEST_CASE("draws Gaussians with reversed depth and with several samples without polygons, with OpenGL") {
  check_same(list_of(scene(300, 0, 2)), {0, 0, 3}, 4);
  Picture picture(SortMethod::thread, 4);
  if (!picture.reverse_depth()) return;
  const RenderList list = list_of(scene(300, 0, 2));
  const std::array<glm::vec3, 4> wall{{{-0.6f, -0.7f, -3}, {0.7f, -0.6f, -3}, {-0.7f, 0.6f, -3}, {0.6f, 0.7f, -3}}};
  const auto polygon = [&] { picture.polygon(wall, {1, 1, 0}); };
  const Pixels wanted = picture.drawn(list, SplatPath::cpu, polygon);
  CHECK(psnr_of(picture.drawn(list, SplatPath::gl, polygon), wanted) >= 45);
}

TEST_CASE("draws at most as many Gaussians of a stream as a changing picture may have") {
  const auto encoded = qnv::encode_gaussians(splat_cloud(20'000), {});
  auto opened = qnv::SplatStream::open(std::get<qnv::EncodedStream>(encoded).bytes);
  qnv::Gaussians gaussians;
  gaussians.stream = std::get<std::unique_ptr<qnv::SplatStream>>(std::move(opened));
  gaussians.description.box = gaussians.stream->box();
  const RenderList list = list_of(std::make_shared<const qnv::Gaussians>(std::move(gaussians)));
  for (const SplatPath path : {SplatPath::gl, SplatPath::cpu}) {
    Picture picture(SortMethod::thread);
    picture.look({0, 0, 3});
    picture.options.splat_error = 0.1f;
    const Pixels whole = picture.drawn(list, path);
    const std::size_t all = picture.statistics.gaussians;
    CHECK(all > 10'000);
    picture.options.most_gaussians = 3000;
    const Pixels few = picture.drawn(list, path);
    CHECK(picture.statistics.gaussians <= 3000);
    CHECK(picture.statistics.gaussians > 1500);
    CHECK(psnr_of(whole, few) > 20);
    picture.options.budget = 1000;
    (void)picture.drawn(list, path);
    CHECK(picture.statistics.gaussians <= 1000);
  }
}

TEST_CASE("keeps the order of Gaussians while the view turns, and has it exactly at rest") {
  const RenderList list = list_of(scene(30'000, 0, 4));
  Picture picture(SortMethod::thread);
  (void)picture.drawn(list, SplatPath::gl);
  CHECK(!picture.statistics.pending);
  for (int frame = 1; frame < 12; ++frame) {
    picture.look({0, 0, 3}, {0.1f * static_cast<float>(frame), 0, 0});
    (void)picture.drawn(list, SplatPath::gl);
    CHECK(!picture.statistics.pending);  // the eye stays, so the order stays
  }
  picture.look({0, 0, 3});
  const Pixels before = picture.drawn(list, SplatPath::gl);
  picture.look({0.05f, 0, 3});
  (void)picture.drawn(list, SplatPath::gl);
  (void)picture.drawn(list, SplatPath::gl);
  CHECK(!picture.statistics.pending);
  Picture fresh(SortMethod::thread);
  fresh.look({0.05f, 0, 3});
  CHECK(picture.drawn(list, SplatPath::gl) == fresh.drawn(list, SplatPath::gl));
  picture.look({0, 0, 3});
  (void)picture.drawn(list, SplatPath::gl);
  CHECK(picture.drawn(list, SplatPath::gl) == before);
}

TEST_CASE("draws Gaussians in the part and in the order of each viewport with OpenGL") {
  const RenderList list = list_of(scene(5000, 1, 4));
  for (const SortMethod sort : {SortMethod::thread, SortMethod::compute})
    for (const int samples : {1, 4}) {
      Picture picture(sort, samples);
      const auto viewport = [&](std::uint32_t number) {
        picture.options.viewport = number;
        picture.options.x = number == 0 ? 0 : 40;
        picture.options.y = number == 0 ? 0 : 7;
        picture.options.width = 40;
        picture.options.height = number == 0 ? 60 : 50;
        picture.look(number == 0 ? glm::vec3(0, 0, 3) : glm::vec3(3, 1, 0));
      };
      std::array<Pixels, 2> wanted;
      for (std::uint32_t number : {0u, 1u}) {
        viewport(number);
        wanted[number] = picture.drawn(list, SplatPath::cpu);
      }
      for (std::uint32_t frame = 0; frame < 6; ++frame) {
        viewport(frame % 2);
        const Pixels drawn = picture.drawn(list, SplatPath::gl);
        CHECK(!picture.statistics.pending);
        CHECK(psnr_of(drawn, wanted[frame % 2]) >= 45);
      }
    }
}

TEST_CASE("sorts Gaussians by distance as std::stable_sort does, by thread and by compute shaders") {
  for (const std::size_t count : {1u, 2u, 300u, 4097u, 20'000u}) {
    auto gaussians = std::make_shared<qnv::Gaussians>(random_gaussians(count, 0, 21));
    // All numbers are exact, and many distances are equal.
    for (glm::vec3& p : gaussians->positions) p = glm::floor(p * 8.0f) / 8.0f;
    SortPart part;
    part.vectors = gaussians;
    part.count = count;
    part.by_distance = true;
    part.eye = {0.25f, -0.5f, 2};
    part.metric[1][1] = 4;
    std::vector<std::uint32_t> wanted(count);
    std::iota(wanted.rbegin(), wanted.rend(), 0u);
    std::ranges::stable_sort(wanted, std::greater(),
                             [&](std::uint32_t i) { return part.depth_of(gaussians->positions[i]); });
    DepthSorter sorter;
    const auto order = sorter.order(std::span(&part, 1));
    CHECK(std::ranges::equal(order.far_first, wanted));
    Picture picture(SortMethod::compute);
    if (!picture.gl.DispatchCompute) continue;
    const auto get = reinterpret_cast<PFNGLGETBUFFERSUBDATAPROC>(picture.context->proc_address("glGetBufferSubData"));
    REQUIRE(get);
    GaussianStore store(picture.gl);
    const std::shared_ptr<const qnv::Gaussians> held = gaussians;
    const auto places = store.place(std::span(&held, 1));
    REQUIRE(places.size() == 1);
    GaussianItem item;
    item.gaussians = gaussians.get();
    item.count = count;
    item.camera_from_node = scale({1, 2, 1}) * translation(-part.eye);
    const Buffer items = make_buffer(picture.gl);
    const Texture texture = make_texture(picture.gl);
    const std::vector<glm::vec4> texels = gaussian_item_texels(std::span(&item, 1), places);
    picture.gl.BindBuffer(GL_TEXTURE_BUFFER, items.name());
    picture.gl.BufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(texels.size() * sizeof texels[0]), texels.data(),
                          GL_STATIC_DRAW);
    picture.gl.BindTexture(GL_TEXTURE_BUFFER, texture.name());
    picture.gl.TexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, items.name());
    const auto sort = DepthGlSort::create(picture.gl, gaussian_keys_shader());
    REQUIRE(sort);
    const Buffer sorted = make_buffer(picture.gl);
    REQUIRE(sort->sort({store.codes().name(), texture.name(), 1}, count, sorted));
    std::vector<std::uint32_t> read(count);
    picture.gl.BindBuffer(GL_ARRAY_BUFFER, sorted.name());
    get(GL_ARRAY_BUFFER, 0, static_cast<GLsizeiptr>(count * sizeof read[0]), read.data());
    CHECK(read == wanted);
  }
}

TEST_CASE("draws the finite ones of hostile Gaussians with OpenGL, as on the processor") {
  qnv::Gaussians hostile = hostile_gaussians();
  Picture picture(SortMethod::compute);
  (void)picture.drawn(list_of(std::make_shared<const qnv::Gaussians>(hostile)), SplatPath::gl);
  CHECK(picture.statistics.splats == std::string("gl"));
  // The processor draws colours of -infinity as black. OpenGL omits them.
  hostile.harmonics[9 * 15].x = 0;
  const auto gaussians = std::make_shared<const qnv::Gaussians>(hostile);
  picture.look({0, 0, 3});
  const Pixels wanted = picture.drawn(list_of(gaussians), SplatPath::cpu);
  const Pixels drawn = picture.drawn(list_of(gaussians), SplatPath::gl);
  CHECK(picture.statistics.splats == std::string("gl"));
  CHECK(psnr_of(drawn, wanted) >= 45);
  RenderList flat = list_of(gaussians);
  flat.splats[0].world_from_node[0] = glm::vec4(0);
  CHECK(plain(picture.drawn(flat, SplatPath::gl), kSky));
  qnv::Gaussians few = random_gaussians(5, 2, 3);
  few.harmonics.pop_back();  // arrays of different lengths: OpenGL refuses them
  GaussianStore store(picture.gl);
  const auto broken = std::make_shared<const qnv::Gaussians>(few);
  CHECK(store.place(std::span(&broken, 1)).empty());
  // Splats that cover the picture too often for a GPU are drawn on the processor, which stops at opaque pixels.
  auto huge = std::make_shared<qnv::Gaussians>(random_gaussians(300'000, 0, 3));
  std::ranges::fill(huge->scales, glm::vec3(40));
  Picture large(SortMethod::thread, 1, 800, 600);
  (void)large.drawn(list_of(huge), SplatPath::gl);
  CHECK(large.statistics.splats == std::string("cpu"));
}

TEST_CASE("shares the memory of Gaussians between viewports, and frees that of gone scenes") {
  Picture picture(SortMethod::thread);
  GaussianStore store(picture.gl, 32 * 1000);
  std::shared_ptr<const qnv::Gaussians> a = scene(400, 0, 1), b = scene(300, 0, 2), c = scene(900, 0, 3);
  CHECK(store.place(std::span(&a, 1)).size() == 1);
  CHECK(store.place(std::span(&b, 1)).size() == 1);
  CHECK(store.bytes() <= 32 * 1000);
  CHECK(store.place(std::span(&c, 1)).size() == 1);
  const std::array both{a, c};
  CHECK(store.place(both).empty());  // 1300 splats exceed the limit
  const std::array twice{a, a};
  const auto places = store.place(twice);
  REQUIRE(places.size() == 2);
  CHECK(places[0].first == places[1].first);
  c = nullptr;
  store.forget_unused();
  CHECK(store.place(std::span(&b, 1)).size() == 1);
}

}  // namespace gs::render::gaussian_gl_test
