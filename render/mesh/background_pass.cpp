#include "render/mesh/background_pass.h"

#include "render/gl/shaders.h"

#include <glm/glm.hpp>
#include <glm/gtc/type_ptr.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>
#include <vector>

namespace gs::render {
namespace {

constexpr std::size_t kMaxRings = 512;  // maximum of sky or ground; both fit into the minimum texture that GL permits

/// View axes of a face of the panorama (VRML97 6.5).
struct Way {
  glm::vec3 ahead, up;
};
constexpr std::array<Way, Background::kFaces> kWays = {{
    {{0, 0, 1}, {0, 1, 0}},    // back
    {{0, -1, 0}, {0, 0, -1}},  // bottom
    {{0, 0, -1}, {0, 1, 0}},   // front
    {{-1, 0, 0}, {0, 1, 0}},   // left
    {{1, 0, 0}, {0, 1, 0}},    // right
    {{0, 1, 0}, {0, 0, 1}},    // top
}};

void append_rings(const std::vector<glm::vec3>& colors, const std::vector<float>& angles, float opacity,
                  std::vector<glm::vec4>& rings) {
  const std::size_t count = std::min({colors.size(), angles.size() + 1, kMaxRings});
  float angle = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) angle = std::max(angle, angles[i - 1]);
    rings.emplace_back(colors[i] * opacity, angle);
  }
}

}  // namespace

std::variant<BackgroundPass, ContextError> BackgroundPass::create(const Gl& gl) {
  auto program = make_program(gl, "", kBackgroundVertexShader, kBackgroundFragmentShader);
  if (auto* error = std::get_if<ContextError>(&program)) return std::move(*error);
  return BackgroundPass(gl, std::move(std::get<Program>(program)));
}

BackgroundPass::BackgroundPass(const Gl& gl, Program program)
    : gl_(&gl),
      program_(std::move(program)),
      no_attributes_(make_vertex_array(gl)),
      rings_(make_texture(gl)),
      background_from_camera_(gl.GetUniformLocation(program_.name(), "background_from_camera")),
      tangents_(gl.GetUniformLocation(program_.name(), "tangents")),
      center_(gl.GetUniformLocation(program_.name(), "center")),
      counts_(gl.GetUniformLocation(program_.name(), "counts")),
      textures_(gl) {
  gl.BindTexture(GL_TEXTURE_2D, rings_.name());
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
}

int BackgroundPass::upload_rings(const Background& background, int& ground_count) {
  std::vector<glm::vec4> rings;
  const float opacity = 1 - background.transparency;  // black is behind the background
  append_rings(background.sky_colors, background.sky_angles, opacity, rings);
  if (rings.empty()) rings.emplace_back(0.0f);
  const int sky_count = static_cast<int>(rings.size());
  append_rings(background.ground_colors, background.ground_angles, opacity, rings);
  ground_count = static_cast<int>(rings.size()) - sky_count;
  gl_->ActiveTexture(GL_TEXTURE0);
  gl_->BindTexture(GL_TEXTURE_2D, rings_.name());
  gl_->BindSampler(0, 0);
  gl_->TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, static_cast<GLsizei>(rings.size()), 1, 0, GL_RGBA, GL_FLOAT,
                  rings.data());
  return sky_count;
}

void BackgroundPass::draw(const Background& background, const glm::mat3& world_from_camera, const Projection& lens,
                          const std::optional<glm::vec3>& color) {
  textures_.forget_unused();
  const bool plain = background.sky_colors.size() <= 1 && background.ground_colors.size() <= 1;
  if (color || plain) {
    const glm::vec3 sky = background.sky_colors.empty() ? glm::vec3(0) : background.sky_colors.front();
    const glm::vec3 one = color ? *color : sky * (1 - background.transparency);
    gl_->ClearColor(one.r, one.g, one.b, 1);
    gl_->Clear(GL_COLOR_BUFFER_BIT);
  } else {
    draw_rings(background, world_from_camera, lens);
  }
  const auto& panorama = background.panorama;
  if (!color && std::any_of(panorama.begin(), panorama.end(), [](const auto& image) { return image != nullptr; }))
    draw_panorama(background, world_from_camera, lens);
}

// Draws horizontal stripes of one colour each, lighter towards the bottom. Needs no compiled program.
void BackgroundPass::draw_backdrop(const PicturePart& part, const DrawOptions& options) {
  constexpr int kStripes = 128;
  constexpr glm::vec3 kBelow(0.16f, 0.17f, 0.19f), kAbove(0.42f, 0.45f, 0.50f);
  const double height = part.top - part.bottom;
  const auto row_of = [&](int stripe) {
    const double place = -1 + 2.0 * stripe / kStripes;
    return std::clamp(static_cast<int>(std::lround((place - part.bottom) / height * options.height)), 0,
                      options.height);
  };
  for (int i = 0; i < kStripes; ++i) {
    const int from = row_of(i), to = row_of(i + 1);
    if (from == to) continue;
    const glm::vec3 color = glm::mix(kBelow, kAbove, (static_cast<float>(i) + 0.5f) / kStripes);
    gl_->Scissor(options.x, options.y + from, options.width, to - from);
    gl_->ClearColor(color.r, color.g, color.b, 1);
    gl_->Clear(GL_COLOR_BUFFER_BIT);
  }
  gl_->Scissor(options.x, options.y, options.width, options.height);
}

void BackgroundPass::draw_rings(const Background& background, const glm::mat3& world_from_camera,
                                const Projection& lens) {
  int ground_count = 0;
  const int sky_count = upload_rings(background, ground_count);
  gl_->UseProgram(program_.name());
  const glm::mat3 background_from_camera = glm::transpose(background.world_from_background) * world_from_camera;
  gl_->UniformMatrix3fv(background_from_camera_, 1, GL_FALSE, glm::value_ptr(background_from_camera));
  gl_->Uniform2f(tangents_, lens.tangents().x, lens.tangents().y);
  gl_->Uniform2f(center_, lens.center().x, lens.center().y);
  gl_->Uniform2i(counts_, sky_count, ground_count);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->Disable(GL_CULL_FACE);
  gl_->Disable(GL_BLEND);
  gl_->BindVertexArray(no_attributes_.name());
  // Many drivers compile the program at the first draw.
  const PhaseScope phase(drawn_ ? nullptr : gl_->phases, Phase::compile);
  drawn_ = true;
  gl_->DrawArrays(GL_TRIANGLES, 0, 3);
}

void BackgroundPass::draw_panorama(const Background& background, const glm::mat3& world_from_camera,
                                   const Projection& lens) {
  if (!std::exchange(tried_panorama_, true)) {
    auto made = make_program(*gl_, "", kPanoramaVertexShader, kPanoramaFragmentShader);
    if (auto* program = std::get_if<Program>(&made)) panorama_ = std::move(*program);
    if (panorama_) {
      camera_from_face_ = gl_->GetUniformLocation(panorama_.name(), "camera_from_face");
      panorama_tangents_ = gl_->GetUniformLocation(panorama_.name(), "tangents");
      panorama_center_ = gl_->GetUniformLocation(panorama_.name(), "center");
    }
  }
  if (!panorama_) return;
  gl_->UseProgram(panorama_.name());
  gl_->Uniform2f(panorama_tangents_, lens.tangents().x, lens.tangents().y);
  gl_->Uniform2f(panorama_center_, lens.center().x, lens.center().y);
  gl_->Disable(GL_DEPTH_TEST);
  gl_->Disable(GL_CULL_FACE);
  gl_->Enable(GL_BLEND);
  gl_->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_->BindVertexArray(no_attributes_.name());
  const glm::mat3 camera_from_background = glm::transpose(world_from_camera) * background.world_from_background;
  for (std::size_t face = 0; face < Background::kFaces; ++face) {
    if (!background.panorama[face]) continue;
    const TextureStore::Entry* texture = textures_.find(background.panorama[face]);
    if (!texture) continue;
    textures_.bind(*texture, false, false);
    const Way& way = kWays[face];
    const glm::mat3 camera_from_face =
        camera_from_background * glm::mat3(glm::cross(way.ahead, way.up), way.up, way.ahead);
    gl_->UniformMatrix3fv(camera_from_face_, 1, GL_FALSE, glm::value_ptr(camera_from_face));
    gl_->DrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }
  gl_->Disable(GL_BLEND);
  gl_->BindSampler(0, 0);
}

}  // namespace gs::render
