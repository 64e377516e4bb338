// Tests of abandoned and coarse pictures, in a rectangle of the bound framebuffer.
#include "tests/render/drawing.h"

#include "render/gl/gpu.h"

#include <vector>

namespace gs::render::given_up_test {
namespace {

using namespace testing;

/// Framebuffer that replaces the window's framebuffer.
class Screen {
 public:
  Screen(GlContext& context, int side) : gl_(std::get<Gl>(Gl::load(context))), side_(side) {
    color_ = make_renderbuffer(gl_);
    framebuffer_ = make_framebuffer(gl_);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    gl_.BindRenderbuffer(GL_RENDERBUFFER, color_.name());
    gl_.RenderbufferStorageMultisample(GL_RENDERBUFFER, 0, GL_RGBA8, side, side);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.name());
    REQUIRE(gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE);
  }
  glm::vec3 at(int x, int y) {
    std::uint8_t pixel[4] = {};
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
    gl_.ReadPixels(x, y, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, pixel);
    return {pixel[0], pixel[1], pixel[2]};
  }
  void clear() {
    const float black[4] = {0, 0, 0, 1};
    gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    gl_.ClearBufferfv(GL_COLOR, 0, black);
  }

 private:
  Gl gl_;
  int side_;
  Renderbuffer color_;
  Framebuffer framebuffer_;
};

/// Returns enough overlapping squares of one colour to draw in slices, before a blue sky.
RenderList squares(const glm::vec3& color) {
  RenderList list;
  list.background.sky_colors = {glm::vec3(0, 0, 1)};
  for (int i = 0; i < 5000; ++i)
    add(list, glowing(square(20), color, translation({0, 0, -0.001f * static_cast<float>(i)})));
  return list;
}

}  // namespace

TEST_CASE("keeps the last complete picture of a viewport after an abandoned one") {
  Drawing drawing;
  Screen screen(drawing.context(), 64);
  drawing.options.x = drawing.options.y = 16;
  drawing.options.width = drawing.options.height = 32;
  bool patient = true;
  drawing.options.go_on = [&] { return patient; };
  const auto draw = [&](const RenderList& list) {
    screen.clear();
    return drawing.renderer().draw(list, camera_at({0, 0, 10}), drawing.options);
  };
  CHECK_FALSE(draw(squares({1, 0, 0})).given_up);
  CHECK(screen.at(32, 32) == glm::vec3(255, 0, 0));
  CHECK(screen.at(4, 4) == glm::vec3(0));
  patient = false;
  REQUIRE(draw(squares({0, 1, 0})).given_up);
  for (const int at : {17, 32, 46}) CHECK(screen.at(at, at) == glm::vec3(255, 0, 0));
  CHECK(screen.at(4, 4) == glm::vec3(0));
  // Shows the last picture stretched if the viewport has another size now.
  drawing.options.width = 40;
  REQUIRE(draw(squares({0, 1, 0})).given_up);
  CHECK(screen.at(54, 32) == glm::vec3(255, 0, 0));
  drawing.options.width = 32;
  // Another viewport has no picture yet.
  drawing.options.viewport = 1;
  REQUIRE(draw(squares({0, 1, 0})).given_up);
  CHECK(screen.at(32, 32) != glm::vec3(255, 0, 0));
  drawing.options.viewport = 0;
  patient = true;
  CHECK_FALSE(draw(squares({0, 1, 0})).given_up);
  CHECK(screen.at(32, 32) == glm::vec3(0, 255, 0));
}

TEST_CASE("shows the last complete picture of a viewport again without drawing, also after it moved") {
  Drawing drawing;
  Screen screen(drawing.context(), 64);
  drawing.options.width = drawing.options.height = 32;
  drawing.options.go_on = [] { return true; };
  CHECK_FALSE(drawing.renderer().show_again(drawing.options));
  RenderList list;
  add(list, glowing(square(20), {1, 0, 0}));
  for (const int samples : {1, 4}) {
    CAPTURE(samples);
    drawing.options.samples = samples;
    drawing.options.x = drawing.options.y = 0;
    screen.clear();
    (void)drawing.renderer().draw(list, camera_at({0, 0, 10}), drawing.options);
    screen.clear();
    drawing.options.x = drawing.options.y = 16;
    CHECK(drawing.renderer().show_again(drawing.options));
    for (const int at : {16, 32, 47}) CHECK(screen.at(at, at) == glm::vec3(255, 0, 0));
    CHECK(screen.at(15, 15) == glm::vec3(0));
    CHECK(screen.at(48, 48) == glm::vec3(0));
  }
  drawing.options.viewport = 7;
  CHECK_FALSE(drawing.renderer().show_again(drawing.options));
}

TEST_CASE("draws large meshes in a later frame if the caller does not wait for their upload") {
  Drawing drawing;
  drawing.options.width = drawing.options.height = 32;
  // Each mesh exceeds the bytes that are uploaded without asking the pacer.
  RenderList list;
  constexpr int kMeshes = 3;
  for (int i = 0; i < kMeshes; ++i) {
    auto large = std::make_shared<vrml::Mesh>(*square(1));
    const Array<std::uint32_t> indices = large->indices;
    while (large->indices.size() < std::size_t{3} << 19)
      for (const std::uint32_t index : indices) large->indices.push_back(index);
    add(list, glowing(large, {1, 0, 0}, translation({0, 0, -static_cast<float>(i)})));
  }
  int asked = 0;
  drawing.options.go_on = [&] {
    ++asked;
    return false;
  };
  const auto given_up = [&] { return drawing.renderer().draw(list, camera_at({0, 0, 10}), drawing.options).given_up; };
  for (int i = 1; i <= kMeshes; ++i) {
    CHECK(given_up());
    CHECK(asked == i);  // each picture uploads one mesh
  }
  asked = 0;
  drawing.options.go_on = [&] {
    ++asked;
    return true;
  };
  CHECK_FALSE(given_up());
}

TEST_CASE("fills the whole rectangle with a coarse picture, and reports that a better one follows") {
  Drawing drawing;
  Screen screen(drawing.context(), 64);
  for (const int samples : {1, 4})
    for (const float coarseness : {1.25f, 2.0f, 3.0f, 8.0f}) {
      drawing.options.samples = samples;
      drawing.options.coarseness = coarseness;
      drawing.options.x = 16;
      drawing.options.y = 0;
      drawing.options.width = 33;
      drawing.options.height = 64;
      CAPTURE(samples, coarseness);
      RenderList list;
      list.background.sky_colors = {glm::vec3(0, 0, 1)};
      add(list, glowing(square(3), {1, 0, 0}));
      screen.clear();
      CHECK(drawing.renderer().draw(list, camera_at({0, 0, 10}), drawing.options).pending);
      CHECK(screen.at(32, 32) == glm::vec3(255, 0, 0));
      for (const auto& [x, y] : {std::pair{16, 0}, {48, 0}, {16, 63}, {48, 63}}) {
        CAPTURE(x, y, screen.at(x, y).x, screen.at(x, y).z);
        CHECK(screen.at(x, y) == glm::vec3(0, 0, 255));
      }
      CHECK(screen.at(15, 32) == glm::vec3(0));
      CHECK(screen.at(49, 32) == glm::vec3(0));
    }
}

}  // namespace gs::render::given_up_test
