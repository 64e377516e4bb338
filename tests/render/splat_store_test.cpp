#include "render/splat_store.h"
#include "qnv/record.h"
#include "render/splat_shaders.h"
#include "splat_scenes.h"

#include <glm/gtc/type_ptr.hpp>

#include <array>
#include <string>

using namespace gs;
using namespace gs::render;
using namespace gs::render::testing;

TEST_CASE("Clouds are forgotten with their last holder") {
  OpenContext open;
  SplatStore store(open.gl, 100000);
  auto first = sphere(1000), second = sphere(3000), third = sphere(5000);
  REQUIRE(store.find(first));
  CHECK(store.bytes() == 16000);
  REQUIRE(store.find(second));
  CHECK(store.bytes() == 64000);
  // No room while this frame needs the others; later, the one that was drawn longest ago makes way.
  CHECK(!store.find(third));
  store.forget_unused();
  REQUIRE(store.find(first));
  store.forget_unused();
  CHECK(store.bytes() == 64000);
  REQUIRE(store.find(third));
  CHECK(store.bytes() == 96000);
  third.reset();
  store.forget_unused();
  CHECK(store.bytes() == 16000);
  first.reset();
  store.forget_unused();
  CHECK(store.bytes() == 0);
  const auto cells = octree_sphere(1000);
  REQUIRE(store.find(cells));
  CHECK(store.bytes() == 20 * cells->size());
}

TEST_CASE("Codes of 16 bytes keep a disc's place, normal and size") {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(-1, 1);
  qnv::Cloud cloud;
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

TEST_CASE("The vertex shader unpacks records to the bits of unpack_records") {
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
flat out vec4 place_weight, normal_color;
void main() {
  vec3 position, normal;
  float weight;
  int color;
  unpack_record(position, normal, weight, color);
  place_weight = vec4(position, weight);
  normal_color = vec4(normal, float(color));
  gl_Position = vec4((float(gl_VertexID & 63) + 0.5) / 32.0 - 1.0, (float(gl_VertexID >> 6) + 0.5) / 32.0 - 1.0, 0.0, 1.0);
}
)glsl";
  auto made = make_program(gl, "#define RECORDS\n#define PI 3.14159265\n", vertex, R"glsl(
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
  const Buffer buffer = make_buffer(gl);
  const VertexArray attributes = make_vertex_array(gl);
  gl.BindVertexArray(attributes.name());
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.name());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(records.size()), records.data(), GL_STATIC_DRAW);
  gl.EnableVertexAttribArray(0);
  gl.VertexAttribIPointer(0, 2, GL_UNSIGNED_INT, 8, nullptr);
  gl.UseProgram(program);
  const glm::vec3 half = frame.cell * 0.5f;
  gl.Uniform3fv(gl.GetUniformLocation(program, "frame_lower"), 1, glm::value_ptr(frame.lower));
  gl.Uniform3fv(gl.GetUniformLocation(program, "frame_step"), 1, glm::value_ptr(half));
  gl.Uniform1f(gl.GetUniformLocation(program, "weight_step"), frame.weight_step);
  gl.Uniform1i(gl.GetUniformLocation(program, "normal_table"), 0);
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
