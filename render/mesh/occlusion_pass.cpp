#include "render/mesh/occlusion_pass.h"

#include "render/gl/shaders.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr int kMostSamples = 16;  // samples of a pixel that are read

// Computes the visible fraction of the ambient light of each pixel, with 16 samples on a spiral. With SAMPLES, reads
// another sample in each of some adjacent pixels: near corners the result depends on the place in the pixel, and
// smoothing averages it.
constexpr char kOcclusionShader[] = R"glsl(
#ifdef SAMPLES
uniform sampler2DMS depths;
uniform vec2 sample_places[MOST_SAMPLES];  // in the pixel, 0 to 1
uniform int sample_count;
// The vectors to a neighbour in the row and to one in the column must not be parallel.
int sample_of(ivec2 pixel) {
  return sample_count > 2 ? ((pixel.x + 2 * pixel.y) & 3) * sample_count / 4 : pixel.x & 1;
}
float depth_at(ivec2 pixel) { return texelFetch(depths, pixel, sample_of(pixel)).r; }
vec2 center_of(ivec2 pixel) { return vec2(pixel) + sample_places[sample_of(pixel)]; }
#define SIZE textureSize(depths)
#else
uniform sampler2D depths;
float depth_at(ivec2 pixel) { return texelFetch(depths, pixel, 0).r; }
vec2 center_of(ivec2 pixel) { return vec2(pixel) + 0.5; }
#define SIZE textureSize(depths, 0)
#endif
uniform vec2 tangents, center;  // tangents of half the angles of view, and of the image centre
uniform vec2 depth_of;  // window depth at distance d is x + y / d
uniform float radius, far;  // world units; window depth of the background
out vec4 result;

// Returns the place of a pixel in camera space.
vec3 place_at(ivec2 pixel) {
  pixel = clamp(pixel, ivec2(0), SIZE - 1);
  float d = depth_of.y / (depth_at(pixel) - depth_of.x);
  vec2 corner = center_of(pixel) / vec2(SIZE) * 2.0 - 1.0;
  return vec3(corner * tangents + center, -1.0) * d;
}

void main() {
  const int kSamples = 16;
  ivec2 pixel = ivec2(gl_FragCoord.xy), size = SIZE;
  vec3 place = place_at(pixel);
  // Of two neighbours, the nearer one is more likely on the same surface.
  vec3 left = place - place_at(pixel - ivec2(1, 0)), right = place_at(pixel + ivec2(1, 0)) - place;
  vec3 below = place - place_at(pixel - ivec2(0, 1)), above = place_at(pixel + ivec2(0, 1)) - place;
  vec3 n = cross(abs(left.z) < abs(right.z) ? left : right, abs(below.z) < abs(above.z) ? below : above);
  float length_of_n = length(n);
  float reach = radius / (-place.z * tangents.y) * float(size.y) * 0.5;  // pixels
  if (depth_at(pixel) == far || length_of_n == 0.0 || reach < 2.0) {
    result = vec4(1.0);
    return;
  }
  n /= length_of_n;
  float limited = min(reach, 0.1 * float(size.y)), scale = limited / reach * radius;
  float turn = float((pixel.x & 3) * 4 + (pixel.y & 3)) / 16.0 * 6.2831853;
  float sum = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    float part = (float(i) + 0.5) / float(kSamples), angle = part * 6.2831853 * 7.0 + turn;
    vec3 away = (place_at(pixel + ivec2(part * limited * vec2(cos(angle), sin(angle)))) - place) / scale;
    float square = dot(away, away), height = dot(away, n) - 0.05;
    float near = max(1.0 - square, 0.0);
    sum += near * near * near * max(height / (square + 0.01), 0.0);
  }
  result = vec4(vec3(max(1.0 - 1.25 * sum / float(kSamples), 0.0)), 1.0);
}
)glsl";

// Averages squares of 4 x 4 pixels, which have all 16 rotations of the spiral.
constexpr char kSmoothingShader[] = R"glsl(
uniform sampler2D depths;
out vec4 result;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(depths, 0) - 1;
  float sum = 0.0;
  for (int y = -2; y < 2; ++y)
    for (int x = -2; x < 2; ++x) sum += texelFetch(depths, clamp(pixel + ivec2(x, y), ivec2(0), last), 0).r;
  result = vec4(vec3(sum / 16.0), 1.0);
}
)glsl";

}  // namespace

OcclusionPass::Target OcclusionPass::make_target(GLenum format, GLenum components, GLenum type, GLenum attachment,
                                                 int samples) const {
  Target target{make_texture(gl_), make_framebuffer(gl_)};
  const GLenum kind = samples > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D;
  gl_.BindTexture(kind, target.texture.name());
  if (samples > 1) {
    gl_.TexImage2DMultisample(kind, samples, format, size_.x, size_.y, GL_TRUE);
  } else {
    gl_.TexImage2D(kind, 0, static_cast<GLint>(format), size_.x, size_.y, 0, components, type, nullptr);
    gl_.TexParameteri(kind, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl_.TexParameteri(kind, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  }
  gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, attachment, kind, target.texture.name(), 0);
  const GLenum none = GL_NONE;
  if (attachment == GL_DEPTH_ATTACHMENT) gl_.DrawBuffers(1, &none);
  if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return {};
  return target;
}

/// Makes the programs at first use, and the targets for a new size or number of samples.
bool OcclusionPass::prepare(const glm::ivec2& size, int samples, GLenum depth_format) {
  if (unusable_) return false;
  const auto make = [&](Program& program, const char* defines, const char* shader) {
    if (program) return;
    auto made = make_program(gl_, defines, kScreenVertexShader, shader);
    if (Program* ready = std::get_if<Program>(&made)) program = std::move(*ready);
  };
  const std::string defines = "#define SAMPLES\n#define MOST_SAMPLES " + std::to_string(kMostSamples) + "\n";
  Program& occlusion = samples > 1 ? occlusion_of_samples_ : occlusion_;
  make(occlusion, samples > 1 ? defines.c_str() : "", kOcclusionShader);
  make(smoothing_, "", kSmoothingShader);
  if (occlusion && smoothing_ && (size != size_ || samples != samples_ || depth_format != depth_format_)) {
    take_errors(gl_);
    size_ = size;
    samples_ = samples;
    depth_format_ = depth_format;
    depth_ = {};
    depth_ = make_target(depth_format, GL_DEPTH_COMPONENT, GL_FLOAT, GL_DEPTH_ATTACHMENT, samples);
    factors_ = {};
    factors_ = make_target(GL_R8, GL_RED, GL_UNSIGNED_BYTE, GL_COLOR_ATTACHMENT0, 1);
  }
  unusable_ = !occlusion || !smoothing_ || !depth_.framebuffer || !factors_.framebuffer || take_errors(gl_);
  return !unusable_;
}

void OcclusionPass::fill(const Program& program, const Texture& texture, GLenum kind) const {
  gl_.UseProgram(program.name());
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindSampler(0, 0);
  gl_.BindTexture(kind, texture.name());
  gl_.Uniform1i(gl_.GetUniformLocation(program.name(), "depths"), 0);
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void OcclusionPass::draw(const Projection& projection, const glm::ivec2& size, float radius) {
  GLint target = 0, samples = 0;
  gl_.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &target);
  gl_.GetIntegerv(GL_SAMPLES, &samples);
  const auto bound = static_cast<GLuint>(target);
  std::array<glm::vec2, kMostSamples> places{};
  const GLint count = std::clamp(samples, 1, GLint{kMostSamples});
  for (GLint i = 0; samples > 1 && i < count; ++i)
    gl_.GetMultisamplefv(GL_SAMPLE_POSITION, static_cast<GLuint>(i), &places[static_cast<std::size_t>(i)].x);
  // The blit needs the format and the samples of the target's depth buffer.
  const bool ready =
      prepare(size, std::max(samples, 1), gl_.ClipControl ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT24);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, bound);
  if (!ready) return;
  gl_.Disable(GL_DEPTH_TEST);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_CULL_FACE);
  gl_.DepthMask(GL_TRUE);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, depth_.framebuffer.name());
  gl_.BlitFramebuffer(0, 0, size.x, size.y, 0, 0, size.x, size.y, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, factors_.framebuffer.name());
  const Program& occlusion = samples_ > 1 ? occlusion_of_samples_ : occlusion_;
  gl_.UseProgram(occlusion.name());
  const auto at = [&](const char* name) { return gl_.GetUniformLocation(occlusion.name(), name); };
  gl_.Uniform2fv(at("sample_places"), count, &places[0].x);
  gl_.Uniform1i(at("sample_count"), count);
  const glm::vec2 tangents = projection.tangents(), center = projection.center();
  gl_.Uniform2f(at("tangents"), tangents.x, tangents.y);
  gl_.Uniform2f(at("center"), center.x, center.y);
  gl_.Uniform2f(at("depth_of"), projection.depth_offset, projection.depth_scale);
  gl_.Uniform1f(at("radius"), radius);
  gl_.Uniform1f(at("far"), projection.farthest_depth());
  fill(occlusion, depth_.texture, samples_ > 1 ? GL_TEXTURE_2D_MULTISAMPLE : GL_TEXTURE_2D);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, bound);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ZERO, GL_SRC_COLOR, GL_ZERO, GL_ONE);
  fill(smoothing_, factors_.texture, GL_TEXTURE_2D);
  gl_.Disable(GL_BLEND);
}

}  // namespace gs::render
