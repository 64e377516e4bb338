#include "render/splat/splat_store.h"
#include "qnv/codecs/records/record.h"
#include "render/splat/splat_shaders.h"
#include "tests/render/splat_scenes.h"

#include <glm/gtc/type_ptr.hpp>

#include <array>
#include <string>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

namespace {

bool add_splats(SplatStore& store, std::shared_ptr<const qnv::Splats> cloud) { return store.add(std::span(&cloud, 1)); }

/// Returns the codes of a point set on the GPU.
std::vector<SplatCode> codes_of(const OpenContext& open, const SplatStore& store, const qnv::Splats& cloud) {
  const auto get = reinterpret_cast<PFNGLGETBUFFERSUBDATAPROC>(open.context->proc_address("glGetBufferSubData"));
  REQUIRE(get);
  std::vector<SplatCode> codes;
  const SplatStore::Entry* entry = store.find(&cloud);
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

TEST_CASE("drops a point set with its last owner") {
  OpenContext open;
  SplatStore store(open.gl, 100000, 1000);
  auto first = sphere(1000), second = sphere(3000), third = sphere(5000);
  REQUIRE(add_splats(store, first));
  CHECK(store.bytes() == 16000);
  CHECK(store.reserved_bytes() == 16000);
  REQUIRE(add_splats(store, second));
  CHECK(store.bytes() == 64000);
  CHECK(store.find(second.get())->ranges.size() == 3);
  // Refuses a third one in this frame. Later it replaces the one that was drawn longest ago.
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

TEST_CASE("stores small point sets in one buffer and large ones in several") {
  OpenContext open;
  const Gl& gl = open.gl;
  SplatStore store(gl, std::size_t{1} << 20, 2000);
  std::vector<std::shared_ptr<const qnv::Splats>> clouds;
  std::mt19937 random(4);
  for (int i = 0; i < 20; ++i) clouds.push_back(sphere(50 + random() % 200));
  clouds.push_back(sphere(7001, true));
  REQUIRE(store.add(clouds));
  CHECK(!take_errors(gl));
  CHECK(store.find(clouds.back().get())->ranges.size() >= 4);
  CHECK(store.slabs() <= 7);
  const auto check_all = [&] {
    for (const auto& cloud : clouds) {
      const auto coding = splat_coding(*cloud);
      std::vector<SplatCode> wanted(cloud->size());
      encode_splats(*cloud, *coding, 0, wanted);
      CHECK(codes_of(open, store, *cloud) == wanted);
    }
  };
  check_all();
  // Adds and drops point sets at random: no byte leaks.
  for (int round = 0; round < 60; ++round) {
    clouds.erase(clouds.begin() + static_cast<std::ptrdiff_t>(random() % clouds.size()));
    store.forget_unused();
    clouds.push_back(sphere(1 + random() % 3000));
    REQUIRE(store.add(clouds));
    std::size_t bytes = 0;
    for (const auto& cloud : clouds) bytes += 16 * cloud->size();
    CHECK(store.bytes() == bytes);
  }
  check_all();
  clouds.clear();
  store.forget_unused();
  CHECK(store.bytes() == 0);
  CHECK(store.reserved_bytes() == 0);
  CHECK(!take_errors(gl));
}

TEST_CASE("splits a point set if no slab has enough contiguous space") {
  OpenContext open;
  SplatStore store(open.gl, 16 * 8192, 8192);
  // 8 of 1024, of which every other one is dropped.
  std::vector<std::shared_ptr<const qnv::Splats>> clouds;
  for (int i = 0; i < 8; ++i) clouds.push_back(sphere(1024));
  REQUIRE(store.add(clouds));
  for (std::ptrdiff_t i = 3; i >= 0; --i) clouds.erase(clouds.begin() + 2 * i);
  store.forget_unused();
  REQUIRE(store.add(clouds));  // marks them as used in this frame
  const auto large = sphere(4096);
  REQUIRE(add_splats(store, large));
  CHECK(store.find(large.get())->ranges.size() == 4);
  CHECK(store.reserved_bytes() == 16 * 8192);
}

TEST_CASE("stores position, normal and size of a splat in 16 bytes") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  qnv::Splats cloud;
  for (int i = 0; i < 1000; ++i) {
    cloud.positions.push_back(glm::vec3(any(random), any(random), any(random)) * 10.0f);
    cloud.normals.push_back(glm::normalize(glm::vec3(any(random), any(random), any(random))));
    cloud.weights.push_back(std::exp(8 * any(random)));
    cloud.cells.push_back({std::exp(3 * any(random)), any(random) * 0.01f});
  }
  cloud.cells[5].edge = 0;
  const auto coding = splat_coding(cloud);
  REQUIRE(coding);
  std::vector<SplatCode> codes(cloud.size());
  std::vector<CellCode> cells(cloud.size());
  encode_splats(cloud, *coding, 0, codes);
  encode_cells(cloud, *coding, 0, cells);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const SplatCode& c = codes[i];
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = static_cast<float>(c[static_cast<std::size_t>(axis)] & 0xfffff);
      CHECK(std::abs(coding->lower[axis] + at * coding->step[axis] - cloud.positions[i][axis]) < 1.2e-5f);
    }
    const std::uint32_t more = c[3] >> 24, u = c[0] >> 20 | (more & 3) << 12, v = c[1] >> 20 | (more >> 2 & 3) << 12,
                        radius = c[2] >> 20 | (more >> 4) << 12;
    const float x = static_cast<float>(u) / 8191 - 1, y = static_cast<float>(v) / 8191 - 1;
    glm::vec3 n(x, y, 1 - std::abs(x) - std::abs(y));
    if (n.z < 0) {
      n.x = (1 - std::abs(y)) * (x < 0 ? -1.0f : 1.0f);
      n.y = (1 - std::abs(x)) * (y < 0 ? -1.0f : 1.0f);
    }
    CHECK(glm::length(glm::normalize(n) - cloud.normals[i]) < 3e-4f);
    const float size = std::exp2(coding->radius.x + static_cast<float>(radius) * coding->radius.y);
    CHECK(size == Approx(std::sqrt(cloud.weights[i] / kPi)).epsilon(2e-4));
    if (i == 5) {
      CHECK((cells[i] & 0xffff) == 0);
      continue;
    }
    const float edge = std::exp2(coding->edge.x + static_cast<float>(cells[i] & 0xffff) * coding->edge.y);
    CHECK(edge == Approx(cloud.cells[i].edge).epsilon(2e-4));
    const float offset = (static_cast<float>(cells[i] >> 16) - 32767) / 32767 * SplatCoding::kOffsetRange * edge;
    CHECK(std::abs(offset - cloud.cells[i].offset) < 1e-4f * edge);
  }
}

TEST_CASE("unpacks records in the vertex shader to the bits of unpack_records") {
  OpenContext open;
  const Gl& gl = open.gl;
  constexpr std::size_t kCount = 4096;
  const std::vector<std::byte> records = random_records(kCount);
  const qnv::RecordFrame frame = qnv::frame_for({{-1, -2, 3}, {4, 0.5f, 3.1f}}, 0.7f);
  std::vector<glm::vec3> positions(kCount), normals(kCount);
  std::vector<float> weights(kCount);
  std::vector<std::uint8_t> colors(kCount);
  qnv::unpack_records(records, frame, positions.data(), normals.data(), weights.data(), colors.data());

  const std::string vertex = std::string(kSplatVectorShader) + R"glsl(
uniform vec3 frame_lower, half_cell;
uniform float weight_step;
flat out vec4 place_weight, normal_color;
void main() {
  vec3 position, normal;
  float weight;
  int color;
  unpack_record(texelFetch(vectors, gl_VertexID).xy, frame_lower, half_cell, weight_step, position, normal, weight, color);
  place_weight = vec4(position, weight);
  normal_color = vec4(normal, float(color));
  gl_Position = vec4((float(gl_VertexID & 63) + 0.5) / 32.0 - 1.0, (float(gl_VertexID >> 6) + 0.5) / 32.0 - 1.0, 0.0, 1.0);
}
)glsl";
  auto made = make_program(gl, "#define RECORDS\n#define PI 3.14159265\n#define PIECES_A_ROW 256\n", vertex, R"glsl(
flat in vec4 place_weight, normal_color;
layout(location = 0) out vec4 first;
layout(location = 1) out vec4 second;
void main() {
  first = place_weight;
  second = normal_color;
}
)glsl");
  if (auto* error = std::get_if<ContextError>(&made)) FAIL(error->message);
  const GLuint program = std::get<Program>(made).name();
  const Framebuffer framebuffer = make_framebuffer(gl);
  const std::array<Texture, 2> targets{make_texture(gl), make_texture(gl)};
  gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer.name());
  for (GLenum i = 0; i < 2; ++i) {
    gl.BindTexture(GL_TEXTURE_2D, targets[i].name());
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, 64, 64, 0, GL_RGBA, GL_FLOAT, nullptr);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0 + i, GL_TEXTURE_2D, targets[i].name(), 0);
  }
  const std::array<GLenum, 2> buffers{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  gl.DrawBuffers(2, buffers.data());
  gl.Viewport(0, 0, 64, 64);
  const Texture table = make_normal_table(gl);
  const VertexArray attributes = make_vertex_array(gl);
  gl.BindVertexArray(attributes.name());
  SplatRecords stored(gl, {}, false);
  REQUIRE(stored.add(records, frame));
  REQUIRE(stored.chunks().size() == 1);
  gl.UseProgram(program);
  const glm::vec3 half = frame.cell * 0.5f;
  gl.Uniform3fv(gl.GetUniformLocation(program, "frame_lower"), 1, glm::value_ptr(frame.lower));
  gl.Uniform3fv(gl.GetUniformLocation(program, "half_cell"), 1, glm::value_ptr(half));
  gl.Uniform1f(gl.GetUniformLocation(program, "weight_step"), frame.weight_step);
  gl.Uniform1i(gl.GetUniformLocation(program, "normal_table"), 0);
  gl.Uniform1i(gl.GetUniformLocation(program, "vectors"), 1);
  gl.ActiveTexture(GL_TEXTURE1);
  gl.BindTexture(GL_TEXTURE_BUFFER, stored.chunks()[0].texture.name());
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, table.name());
  gl.DrawArrays(GL_POINTS, 0, kCount);
  std::vector<glm::vec4> first(kCount), second(kCount);
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl.ReadPixels(0, 0, 64, 64, GL_RGBA, GL_FLOAT, first.data());
  gl.ReadBuffer(GL_COLOR_ATTACHMENT1);
  gl.ReadPixels(0, 0, 64, 64, GL_RGBA, GL_FLOAT, second.data());
  for (std::size_t i = 0; i < kCount; ++i) {
    CHECK(glm::vec3(first[i]) == positions[i]);
    CHECK(first[i].w == weights[i]);
    CHECK(glm::vec3(second[i]) == normals[i]);
    CHECK(second[i].w == static_cast<float>(colors[i]));
  }
}
