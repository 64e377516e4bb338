#include "render/mesh/draw_pacer.h"

#include "tests/render/drawing.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

namespace gs::draw_pacer_test {
namespace {

using namespace render;
using namespace render::testing;

/// Returns a mesh of many overlapping triangles, as opaque and transparent items, lines and points.
RenderList crowded() {
  RenderList list;
  const auto one = square(1);
  for (const auto primitive :
       {vrml::Mesh::Primitive::triangles, vrml::Mesh::Primitive::lines, vrml::Mesh::Primitive::points}) {
    auto mesh = std::make_shared<vrml::Mesh>();
    mesh->primitive = primitive;
    for (std::uint32_t i = 0; i < 9000; ++i) {
      const auto part = [i](std::uint32_t count) {
        return static_cast<float>(i % count) - static_cast<float>(count / 2);
      };
      for (const glm::vec3& p : one->positions) {
        mesh->positions.push_back(p + glm::vec3(part(7), part(5), 0.3f * part(11)));
        mesh->bounds.add(mesh->positions[mesh->positions.size() - 1]);
      }
      for (const std::uint32_t index : one->indices) mesh->indices.push_back(index + 4 * i);
    }
    add(list, glowing(mesh, {0.2f, primitive == vrml::Mesh::Primitive::lines ? 0.5f : 0.9f, 0.9f}));
  }
  const auto shared = square(0.5f);
  for (int i = 0; i < 9000; ++i) {
    DrawItem item = glowing(shared, {0.9f, static_cast<float>(i % 10) * 0.1f, 0.1f},
                            translation({i % 9 - 4, i % 8 - 4, 4 + i % 3}));
    if (i % 2 == 0) item.material.transparency = 0.5f;
    add(list, std::move(item));
  }
  return list;
}

/// Fake driver that records waits; its syncs are the numbers 1, 2, ...
struct Syncs {
  static inline std::uintptr_t made;
  static inline std::vector<std::uintptr_t> waited, deleted;

  static std::uintptr_t number(GLsync sync) { return reinterpret_cast<std::uintptr_t>(sync); }
  static GLsync fence(GLenum, GLbitfield) { return reinterpret_cast<GLsync>(++made); }
  static GLenum wait(GLsync sync, GLbitfield, GLuint64) {
    waited.push_back(number(sync));
    return GL_CONDITION_SATISFIED;
  }
  static void forget(GLsync sync) { deleted.push_back(number(sync)); }
  static void flush() {}
};

}  // namespace

TEST_CASE("limits the triangles per slice for a driver on the processor") {
  Syncs::made = 0;
  Syncs::waited = Syncs::deleted = {};
  Gl gl;
  gl.software = true;
  gl.FenceSync = Syncs::fence;
  gl.ClientWaitSync = Syncs::wait;
  gl.DeleteSync = Syncs::forget;
  gl.Flush = Syncs::flush;
  const std::function<bool()> nobody;
  {
    DrawPacer pacer(gl, nobody, 1'000'000);
    const std::size_t slice = pacer.room();
    CHECK(slice >= 1000);
    CHECK(slice <= 100'000);
    pacer.spend(slice - 1);
    CHECK(Syncs::made == 0);
    pacer.spend(1);
    CHECK(Syncs::made == 1);
    for (int i = 0; i < 4; ++i) pacer.spend(pacer.room());
    CHECK(Syncs::made == 5);
    CHECK(Syncs::waited == std::vector<std::uintptr_t>{1, 2, 3});
    CHECK_FALSE(pacer.given_up());
  }
  CHECK(Syncs::deleted.size() == 5);
  CHECK(std::set<std::uintptr_t>(Syncs::deleted.begin(), Syncs::deleted.end()).size() == 5);
}

TEST_CASE("draws the same picture in slices, to the last bit") {
  Drawing drawing;
  const RenderList list = crowded();
  const Image whole = drawing.draw(list);
  const FrameStatistics statistics = drawing.statistics;
  int asked = 0;
  drawing.options.go_on = [&asked] {
    ++asked;
    return true;
  };
  CHECK(drawing.draw(list).pixels == whole.pixels);
  CHECK(asked > 0);
  CHECK_FALSE(drawing.statistics.given_up);
  CHECK(drawing.statistics.triangles == statistics.triangles);
  CHECK(drawing.statistics.items == statistics.items);
}

TEST_CASE("abandons a picture between two slices, and completes the next one") {
  Drawing drawing;
  const RenderList list = crowded();
  const Image whole = drawing.draw(list);
  drawing.options.go_on = [] { return false; };
  const Image part = drawing.draw(list);
  CHECK(drawing.statistics.given_up);
  CHECK(part.pixels != whole.pixels);
  drawing.options.go_on = nullptr;
  CHECK(drawing.draw(list).pixels == whole.pixels);
  CHECK_FALSE(drawing.statistics.given_up);
}

}  // namespace gs::draw_pacer_test
