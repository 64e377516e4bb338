#include "render/draw/renderer.h"

#include "render/gl/gpu.h"
#include "render/mesh/background_pass.h"
#include "render/mesh/mesh_pass.h"
#include "render/splat/splat_pass.h"
#include "render/volume/volume_pass.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace gs::render {

/// Where draw_to_image draws: with samples, and resolved to one a pixel.
struct OffscreenTarget {
  int width = 0, height = 0, samples = 0;
  Renderbuffer color, depth, resolved_color;
  Framebuffer framebuffer, resolved;
};

namespace {

// Off-screen pictures larger than this give up samples first.
constexpr std::size_t kMostFramebufferBytes = std::size_t{1} << 30;
constexpr std::size_t kBytesPerSample = 8;  // colour and depth

void attach(const Gl& gl, const Renderbuffer& buffer, GLenum format, GLenum attachment, int samples, int width,
            int height) {
  gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.name());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.name());
}

/// Empty framebuffer when the driver cannot.
OffscreenTarget make_target(const Gl& gl, int width, int height, int samples) {
  take_errors(gl);
  OffscreenTarget target{width, height, samples, {}, {}, {}, {}, {}};
  const auto complete = [&] {
    return gl.CheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE && gl.GetError() == GL_NO_ERROR;
  };
  target.color = make_renderbuffer(gl);
  target.depth = make_renderbuffer(gl);
  target.framebuffer = make_framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  const int multiple = samples > 1 ? samples : 0;
  attach(gl, target.color, GL_RGBA8, GL_COLOR_ATTACHMENT0, multiple, width, height);
  attach(gl, target.depth, GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT, multiple, width, height);
  if (!complete()) return {};
  if (multiple == 0) return target;
  target.resolved_color = make_renderbuffer(gl);
  target.resolved = make_framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.resolved.name());
  attach(gl, target.resolved_color, GL_RGBA8, GL_COLOR_ATTACHMENT0, 0, width, height);
  if (!complete()) return {};
  return target;
}

Image read_back(const Gl& gl, int width, int height) {
  Image image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 3, {}};
  const std::size_t row = std::size_t{image.width} * 3;
  image.pixels.resize(row * image.height);
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl.ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.pixels.data());
  gl.PixelStorei(GL_PACK_ALIGNMENT, 4);
  for (std::size_t top = 0, bottom = image.height - 1u; top < bottom; ++top, --bottom)
    std::swap_ranges(image.pixels.begin() + static_cast<std::ptrdiff_t>(top * row),
                     image.pixels.begin() + static_cast<std::ptrdiff_t>((top + 1) * row),
                     image.pixels.begin() + static_cast<std::ptrdiff_t>(bottom * row));
  return image;
}

}  // namespace

struct Renderer::State {
  GlContext* context = nullptr;
  Gl gl;
  std::optional<BackgroundPass> background;
  std::unique_ptr<MeshPass> meshes;
  std::unique_ptr<SplatPass> splats;
  std::unique_ptr<VolumePass> volumes;
  OffscreenTarget target;
};

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

std::variant<std::unique_ptr<Renderer>, ContextError> Renderer::create(GlContext& context, PhaseClock* phases) {
  auto loaded = Gl::load(context);
  if (auto* error = std::get_if<ContextError>(&loaded)) return std::move(*error);
  auto state = std::make_unique<State>();
  state->context = &context;
  state->gl = std::move(std::get<Gl>(loaded));
  state->gl.phases = phases;
  auto background = BackgroundPass::create(state->gl);
  if (auto* error = std::get_if<ContextError>(&background)) return std::move(*error);
  state->background.emplace(std::move(std::get<BackgroundPass>(background)));
  auto meshes = MeshPass::create(state->gl);
  if (auto* error = std::get_if<ContextError>(&meshes)) return std::move(*error);
  state->meshes = std::move(std::get<std::unique_ptr<MeshPass>>(meshes));
  state->splats = std::make_unique<SplatPass>(state->gl);
  state->volumes = std::make_unique<VolumePass>(state->gl);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

FrameStatistics Renderer::draw(const RenderList& list, const Camera& given, const DrawOptions& options) {
  FrameStatistics statistics;
  if (options.width <= 0 || options.height <= 0) return statistics;
  const Gl& gl = state_->gl;
  Camera camera = fit_depth(given, list.bounds);
  if (options.visibility_limit && list.navigation.visibility_limit > 0)
    camera.far_plane = std::max(list.navigation.visibility_limit, camera.near_plane * 2);
  const glm::mat4 clip_from_camera =
      projection(camera, static_cast<float>(options.width), static_cast<float>(options.height));

  gl.Viewport(options.x, options.y, options.width, options.height);
  gl.Scissor(options.x, options.y, options.width, options.height);
  gl.Enable(GL_SCISSOR_TEST);
  gl.Enable(GL_MULTISAMPLE);
  gl.Disable(GL_STENCIL_TEST);
  gl.Disable(GL_DEPTH_TEST);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl.DepthMask(GL_TRUE);
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  gl.DepthMask(GL_FALSE);
  state_->background->draw(list.background, glm::mat3(camera.world_from_camera),
                           {1 / clip_from_camera[0][0], 1 / clip_from_camera[1][1]}, options.background);
  gl.DepthMask(GL_TRUE);
  state_->meshes->draw(list, camera, clip_from_camera, options, statistics, [&] {
    state_->splats->draw(list, camera, clip_from_camera, options, statistics);
    state_->volumes->draw(list, camera, clip_from_camera, options, statistics);
  });
  // Whoever draws next (the user interface) finds the defaults.
  gl.BindVertexArray(0);
  gl.UseProgram(0);
  gl.BindSampler(0, 0);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_DEPTH_TEST);
  return statistics;
}

std::variant<Image, ContextError> Renderer::draw_to_image(const RenderList& list, const Camera& camera,
                                                          const DrawOptions& options, FrameStatistics* statistics) {
  const Gl& gl = state_->gl;
  const int width = options.width, height = options.height, most = gl.max_renderbuffer_size;
  if (width < 1 || height < 1 || width > most || height > most)
    return ContextError{"a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                        " pixels cannot be drawn: each side must be from 1 to " + std::to_string(most)};
  int samples = std::clamp(options.samples, 1, std::max(gl.max_samples, 1));
  const std::size_t bytes =
      std::size_t{1} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kBytesPerSample;
  while (samples > 1 && bytes * static_cast<std::size_t>(samples) > kMostFramebufferBytes) samples /= 2;

  OffscreenTarget& target = state_->target;
  if (!target.framebuffer || target.width != width || target.height != height || target.samples != samples) {
    target = {};
    target = make_target(gl, width, height, samples);
    while (!target.framebuffer && samples > 1) {
      samples /= 2;
      target = make_target(gl, width, height, samples);
    }
  }
  if (!target.framebuffer) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    return ContextError{"the driver has no memory for a picture of " + std::to_string(width) + "x" +
                        std::to_string(height)};
  }
  DrawOptions local = options;
  local.x = local.y = 0;
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  const FrameStatistics drawn = draw(list, camera, local);
  if (statistics) *statistics = drawn;
  if (target.resolved) {
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer.name());
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.resolved.name());
    gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.resolved.name());
  }
  Image image = read_back(gl, width, height);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  return image;
}

const std::string& Renderer::gl_renderer() const { return state_->gl.renderer; }

}  // namespace gs::render
