#include "render/splat/splat_store.h"
#include "tests/render/splat_scenes.h"

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

bool add_splats(SplatStore& store, std::shared_ptr<const qnv::Splats> geometry) {
  return store.add(std::span(&geometry, 1));
}

/// Returns the codes of splats on the GPU.
std::vector<SplatCode> codes_of(const OpenContext& open, const SplatStore& store, const qnv::Splats& geometry) {
  const auto get = reinterpret_cast<PFNGLGETBUFFERSUBDATAPROC>(open.context->proc_address("glGetBufferSubData"));
  REQUIRE(get);
  std::vector<SplatCode> codes;
  const SplatStore::Entry* entry = store.find(&geometry);
  REQUIRE(entry);
  for (const SplatStore::Range& range : entry->ranges) {
    const std::size_t at = codes.size();
    codes.resize(at + range.count);
    open.gl.BindBuffer(GL_TEXTURE_BUFFER, store.slab(range.slab).codes.name());
    get(GL_TEXTURE_BUFFER, static_cast<GLintptr>(range.first * sizeof(SplatCode)),
        static_cast<GLsizeiptr>(range.count * sizeof(SplatCode)), &codes[at]);
  }
  return codes;
}

}  // namespace

TEST_CASE("drops splats with their last owner") {
  OpenContext open;
  SplatStore store(open.gl, 100000, 1000);
  auto first = sphere(1000), second = sphere(3000), third = sphere(5000);
  REQUIRE(add_splats(store, first));
  CHECK(store.bytes() == 16000);
  CHECK(store.reserved_bytes() == 16000);
  REQUIRE(add_splats(store, second));
  CHECK(store.bytes() == 64000);
  CHECK(store.find(second.get())->ranges.size() == 3);
  // The store refuses third splats in this frame. Later they replace the splats that were drawn longest ago.
  CHECK(!add_splats(store, third));
  CHECK(!store.find(third.get()));
  CHECK(store.bytes() == 64000);
  CHECK(store.reserved_bytes() <= 100000);
  store.forget_unused();
  REQUIRE(add_splats(store, first));
  store.forget_unused();
  CHECK(store.bytes() == 64000);
  REQUIRE(add_splats(store, third));
  CHECK(store.bytes() == 96000);
  third.reset();
  store.forget_unused();
  CHECK(store.bytes() == 16000);
  CHECK(store.reserved_bytes() == 16000);
  first.reset();
  store.forget_unused();
  CHECK(store.bytes() == 0);
  CHECK(store.reserved_bytes() == 0);
  const auto cells = octree_sphere(1000);
  REQUIRE(add_splats(store, cells));
  CHECK(store.bytes() == 20 * cells->size());
}

TEST_CASE("stores few splats in one buffer and many in several") {
  OpenContext open;
  const Gl& gl = open.gl;
  SplatStore store(gl, std::size_t{1} << 20, 2000);
  std::vector<std::shared_ptr<const qnv::Splats>> geometries;
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) geometries.push_back(sphere(50 + random() % 200));
  geometries.push_back(sphere(7001, true));
  REQUIRE(store.add(geometries));
  CHECK(!take_errors(gl));
  CHECK(store.find(geometries.back().get())->ranges.size() >= 4);
  CHECK(store.slabs() <= 7);
  const auto check_all = [&] {
    for (const auto& geometry : geometries) {
      const auto coding = splat_coding(*geometry);
      std::vector<SplatCode> wanted(geometry->size());
      encode_splats(*geometry, *coding, 0, wanted);
      CHECK(codes_of(open, store, *geometry) == wanted);
    }
  };
  check_all();
  // Adds and drops splats at random: no byte leaks.
  for (int round = 0; round < 60; ++round) {
    geometries.erase(geometries.begin() + static_cast<std::ptrdiff_t>(random() % geometries.size()));
    store.forget_unused();
    geometries.push_back(sphere(1 + random() % 3000));
    REQUIRE(store.add(geometries));
    std::size_t bytes = 0;
    for (const auto& geometry : geometries) bytes += 16 * geometry->size();
    CHECK(store.bytes() == bytes);
  }
  check_all();
  geometries.clear();
  store.forget_unused();
  CHECK(store.bytes() == 0);
  CHECK(store.reserved_bytes() == 0);
  CHECK(!take_errors(gl));
}

TEST_CASE("splits splats if no slab has enough contiguous space") {
  OpenContext open;
  SplatStore store(open.gl, 16 * 8192, 8192);
  // Stores 8 times 1024 splats, and drops every second of them.
  std::vector<std::shared_ptr<const qnv::Splats>> geometries;
  for (int i = 0; i < 8; ++i) geometries.push_back(sphere(1024));
  REQUIRE(store.add(geometries));
  for (std::ptrdiff_t i = 3; i >= 0; --i) geometries.erase(geometries.begin() + 2 * i);
  store.forget_unused();
  REQUIRE(store.add(geometries));  // marks them as used in this frame
  const auto large = sphere(4096);
  REQUIRE(add_splats(store, large));
  CHECK(store.find(large.get())->ranges.size() == 4);
  CHECK(store.reserved_bytes() == 16 * 8192);
}

TEST_CASE("stores position, normal and size of a splat in 16 bytes") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  qnv::Splats geometry;
  for (int i = 0; i < 1000; ++i) {
    geometry.positions.push_back(glm::vec3(any(random), any(random), any(random)) * 10.0f);
    geometry.normals.push_back(glm::normalize(glm::vec3(any(random), any(random), any(random))));
    geometry.weights.push_back(std::exp(8 * any(random)));
    geometry.cells.push_back({std::exp(3 * any(random)), any(random) * 0.01f});
  }
  geometry.cells[5].edge = 0;
  const auto coding = splat_coding(geometry);
  REQUIRE(coding);
  std::vector<SplatCode> codes(geometry.size());
  std::vector<CellCode> cells(geometry.size());
  encode_splats(geometry, *coding, 0, codes);
  encode_cells(geometry, *coding, 0, cells);
  for (std::size_t i = 0; i < geometry.size(); ++i) {
    const SplatCode& c = codes[i];
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<float>(c[static_cast<std::size_t>(axis)] & 0xfffff);
      CHECK(std::abs(coding->lower[axis] + at * coding->step[axis] - geometry.positions[i][axis]) < 1.2e-5f);
    }
    const std::uint32_t more = c[3] >> 24, u = c[0] >> 20 | (more & 3) << 12, v = c[1] >> 20 | (more >> 2 & 3) << 12,
                        radius = c[2] >> 20 | (more >> 4) << 12;
    const float x = static_cast<float>(u) / 8191 - 1, y = static_cast<float>(v) / 8191 - 1;
    glm::vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
    if (n.z < 0) {
      n.x = (1 - std::abs(y)) * (x < 0 ? -1.0f : 1.0f);
      n.y = (1 - std::abs(x)) * (y < 0 ? -1.0f : 1.0f);
    }
    CHECK(glm::length(glm::normalize(n) - geometry.normals[i]) < 3e-4f);
    const float size = std::exp2(coding->radius.x + static_cast<float>(radius) * coding->radius.y);
    CHECK(size == Approx(std::sqrt(geometry.weights[i] / kPi)).epsilon(2e-4));
    if (i == 5) {
      CHECK((cells[i] & 0xffff) == 0);
      continue;
    }
    const float edge = std::exp2(coding->edge.x + static_cast<float>(cells[i] & 0xffff) * coding->edge.y);
    CHECK(edge == Approx(geometry.cells[i].edge).epsilon(2e-4));
    const float offset = (static_cast<float>(cells[i] >> 16) - 32767) / 32767 * SplatCoding::kOffsetRange * edge;
    CHECK(std::abs(offset - geometry.cells[i].offset) < 1e-4f * edge);
  }
}
