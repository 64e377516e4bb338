#include "render/draw/renderer.h"

#include "render/collection/collector.h"
#include "render/draw/cube_pass.h"
#include "render/draw/layer_parts.h"
#include "render/draw/off_screen.h"
#include "render/gaussians/gaussian_overlap.h"
#include "render/gaussians/gaussian_pass.h"
#include "render/gl/gpu.h"
#include "render/mesh/background_pass.h"
#include "render/mesh/mesh_pass.h"
#include "render/mesh/occlusion_pass.h"
#include "render/splat/splat_pass.h"
#include "render/surface/surface_pass.h"
#include "render/volume/volume_pass.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace gs::render {
namespace {

// Maximum bytes of an off-screen image. Larger images get fewer samples.
constexpr std::size_t kMaxFramebufferBytes = std::size_t{1} << 30;
constexpr std::size_t kBytesPerSample = 8;  // colour and depth
constexpr float kMaxCoarseness = 16;

}  // namespace

struct Renderer::State {
  GlContext* context = nullptr;
  Gl gl;
  std::optional<BackgroundPass> background;
  std::unique_ptr<MeshPass> meshes;
  std::unique_ptr<SplatPass> splats;
  std::unique_ptr<SurfacePass> surfaces;
  std::unique_ptr<VolumePass> volumes;
  std::unique_ptr<GaussianPass> gaussians;
  std::optional<CubePass> cubes;
  std::optional<OcclusionPass> occlusion;  // made at first use
  OffscreenTarget target;
  std::map<std::uint32_t, FormerPicture> former;  // by viewport; kept for drawing that can be cancelled
};

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

std::variant<std::unique_ptr<Renderer>, ContextError> Renderer::create(GlContext& context) {
  auto loaded = Gl::load(context);
  if (auto* error = std::get_if<ContextError>(&loaded)) return std::move(*error);
  auto state = std::make_unique<State>();
  state->context = &context;
  state->gl = std::move(std::get<Gl>(loaded));
  auto background = BackgroundPass::create(state->gl);
  if (auto* error = std::get_if<ContextError>(&background)) return std::move(*error);
  state->background.emplace(std::move(std::get<BackgroundPass>(background)));
  auto meshes = MeshPass::create(state->gl);
  if (auto* error = std::get_if<ContextError>(&meshes)) return std::move(*error);
  state->meshes = std::move(std::get<std::unique_ptr<MeshPass>>(meshes));
  state->cubes.emplace(state->gl);
  state->splats = std::make_unique<SplatPass>(state->gl);
  state->surfaces = std::make_unique<SurfacePass>(state->gl);
  state->volumes = std::make_unique<VolumePass>(state->gl);
  state->gaussians = std::make_unique<GaussianPass>(state->gl);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

/// Binds a target of at least this size. Reduces the samples if the driver has too little memory.
bool Renderer::bind_target(int width, int height, int samples) {
  const Gl& gl = state_->gl;
  const int most = gl.max_renderbuffer_size;
  if (width > most || height > most) return false;
  samples = std::clamp(samples, 1, std::max(gl.max_samples, 1));
  const std::size_t bytes =
      std::size_t{1} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * kBytesPerSample;
  while (samples > 1 && bytes * static_cast<std::size_t>(samples) > kMaxFramebufferBytes) samples /= 2;
  OffscreenTarget& target = state_->target;
  const bool fits = target.framebuffer && target.samples == samples && target.width >= width &&
                    target.height >= height && target.width <= 2 * width && target.height <= 2 * height;
  if (!fits) {
    target = {};
    target = make_target(gl, width, height, samples);
    for (int fewer = samples / 2; !target.framebuffer && fewer > 0; fewer /= 2) {
      target = make_target(gl, width, height, fewer);
      target.samples = samples;
    }
  }
  if (target.framebuffer) gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
  return static_cast<bool>(target.framebuffer);
}

FrameStatistics Renderer::draw(const RenderList& list, const Camera& camera, const DrawOptions& options) {
  if (options.width <= 0 || options.height <= 0) return {};
  const Gl& gl = state_->gl;
  GLint outer = 0, outer_samples = 0;
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &outer);
  gl.GetIntegerv(GL_SAMPLES, &outer_samples);
  const float coarseness = std::clamp(options.coarseness, 1.0f, kMaxCoarseness);
  const auto reduced = [&](int side) { return static_cast<int>(std::ceil(static_cast<float>(side) / coarseness)); };
  DrawOptions coarse = options;
  coarse.width = reduced(options.width);
  coarse.height = reduced(options.height);
  const DrawOptions local = for_target(gl, list, coarse, outer_samples == 0);
  if (!bind_target(local.width, local.height, std::min(local.samples, local.target_samples))) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(outer));
    return {};
  }
  FrameStatistics statistics = draw_in_target(list, camera, local);
  statistics.pending = statistics.pending || coarseness > 1;
  // A blit resolves multisampling only into a target of equal size without multisampling, so resolve first.
  if (outer_samples > 0 || coarseness > 1) resolve(local.width, local.height);
  int width = local.width, height = local.height;
  // Stretch a copy of exactly the image: the filter would otherwise blend pixels outside of it.
  if (options.go_on || coarseness > 1) keep_whole_picture(options, statistics.given_up, width, height);
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(outer));
  // With pixels as samples, the linear filter averages the four pixels of each result.
  const bool same_size = width == options.width && height == options.height;
  gl.BlitFramebuffer(0, 0, width, height, options.x, options.y, options.x + options.width, options.y + options.height,
                     GL_COLOR_BUFFER_BIT, same_size ? GL_NEAREST : GL_LINEAR);
  gl.BindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(outer));
  if (options.go_on && gl.software) gl.Finish();  // callers that can cancel drawing also measure its time
  return statistics;
}

bool Renderer::show_again(const DrawOptions& options) {
  const auto former = state_->former.find(options.viewport);
  if (former == state_->former.end() || !former->second.framebuffer || options.width <= 0 || options.height <= 0)
    return false;
  const Gl& gl = state_->gl;
  GLint outer = 0;
  gl.GetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &outer);
  const FormerPicture& kept = former->second;
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, kept.framebuffer.name());
  const bool same_size = kept.width == options.width && kept.height == options.height;
  gl.BlitFramebuffer(0, 0, kept.width, kept.height, options.x, options.y, options.x + options.width,
                     options.y + options.height, GL_COLOR_BUFFER_BIT, same_size ? GL_NEAREST : GL_LINEAR);
  gl.BindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(outer));
  return true;
}

/// Copies the complete image that is bound for reading, `width` x `height` pixels, for its viewport. If drawing was
/// cancelled, binds the viewport's last complete image instead and returns its size in `width` and `height`.
void Renderer::keep_whole_picture(const DrawOptions& options, bool given_up, int& width, int& height) {
  const Gl& gl = state_->gl;
  FormerPicture& former = state_->former[options.viewport];
  if (!given_up) {
    GLint drawn = 0;
    gl.GetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &drawn);
    if (former.width != width || former.height != height) {
      former = {};
      former = make_picture(gl, width, height);
    }
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(drawn));
    if (!former.framebuffer) return;
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, former.framebuffer.name());
    gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  if (!former.framebuffer) return;
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, former.framebuffer.name());
  width = former.width;
  height = former.height;
}

void Renderer::resolve(int width, int height) {
  const OffscreenTarget& target = state_->target;
  if (!target.resolved) return;
  const Gl& gl = state_->gl;
  gl.BindFramebuffer(GL_READ_FRAMEBUFFER, target.framebuffer.name());
  gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, target.resolved.name());
  gl.BlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.resolved.name());
}

// Draws a world. If it has layers, draws them from back to front, each in its part of the picture.
FrameStatistics Renderer::draw_in_target(const RenderList& list, const Camera& camera, const DrawOptions& options) {
  if (list.layers.empty() && list.boundary == kWholePicture && list.drawn)
    return draw_layer(list, camera, options, false);
  FrameStatistics statistics;
  bool drawn = false;
  const auto draw_one = [&](const RenderList& one, const Camera& lens, const DrawOptions& of_layer) {
    const std::optional<LayerPart> part = part_of(one.boundary, lens, of_layer);
    if (!part || statistics.given_up) return;
    const bool first = !std::exchange(drawn, true),
               whole = part->options.width == options.width && part->options.height == options.height;
    if (first && !whole) (void)draw_layer(RenderList(), lens, options, false);  // the background around the layer
    add_to(statistics, draw_layer(one, part->camera, part->options, !first || !whole));
  };
  for (const bool in_front : {false, true}) {
    if (in_front && list.drawn) draw_one(list, camera, options);
    for (std::size_t i = 0; i < list.layers.size(); ++i) {
      const RenderLayer& layer = list.layers[i];
      if (layer.in_front == in_front)
        draw_one(*layer.list, lens_of(layer, camera, options), options_of(layer, i, options));
    }
  }
  if (!drawn) (void)draw_layer(RenderList(), camera, options, false);
  return statistics;
}

/// Draws one list. If `in_front`, the layers drawn before remain visible behind it, unless a Background is bound in its
/// layer.
FrameStatistics Renderer::draw_layer(const RenderList& list, const Camera& wanted, const DrawOptions& options,
                                     bool in_front) {
  FrameStatistics statistics;
  state_->cubes->draw(list, options, *state_->meshes, [&](const Camera& face, const DrawOptions& of_face) {
    (void)draw_layer(list, face, of_face, false);
  });
  WideBox bounds = list.bounds;
  if (options.guides) bounds.add(options.guides->bounds);
  const Camera given = far_camera(wanted, bounds);
  const Gl& gl = state_->gl;
  const bool reversed = gl.ClipControl != nullptr;
  Camera camera = given;
  if (options.visibility_limit && list.navigation.visibility_limit > 0)
    camera.far_plane = list.navigation.visibility_limit * options.unit + static_cast<float>(camera.back);
  if (options.visibility_limit && list.far_distance > 0) {
    const float farthest = list.far_distance * options.unit + static_cast<float>(camera.back);
    camera.far_plane = camera.far_plane > 0 ? std::min(camera.far_plane, farthest) : farthest;
  }
  const float nearest = list.near_distance * options.unit + static_cast<float>(camera.back);
  if (options.visibility_limit && list.near_distance > 0 && !(camera.far_plane > 0 && camera.far_plane <= nearest))
    camera.near_plane = nearest;
  camera = fit_depth(camera, bounds, reversed);
  const Projection lens =
      projection(camera, static_cast<float>(options.width), static_cast<float>(options.height), reversed);

  if (reversed) gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  gl.Viewport(options.x, options.y, options.width, options.height);
  gl.Scissor(options.x, options.y, options.width, options.height);
  gl.Enable(GL_SCISSOR_TEST);
  gl.Enable(GL_MULTISAMPLE);
  gl.Disable(GL_STENCIL_TEST);
  gl.Disable(GL_DEPTH_TEST);
  gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  gl.DepthMask(GL_TRUE);
  const float farthest = lens.farthest_depth();
  gl.ClearBufferfv(GL_DEPTH, 0, &farthest);
  gl.DepthMask(GL_FALSE);
  // In parallel projection, infinitely distant content would have only one direction, so draw it in perspective.
  Camera perspective = wanted;
  perspective.height = 0;
  Camera sky = perspective;
  sky.near_plane = camera.near_plane;
  sky.far_plane = camera.far_plane;
  const Projection sky_lens =
      projection(sky, static_cast<float>(options.width), static_cast<float>(options.height), reversed);
  const bool shows_behind = in_front && (!list.has_background || options.background);
  if (!shows_behind && options.backdrop && !options.background)
    state_->background->draw_backdrop(camera.part, options);
  else if (!shows_behind)
    state_->background->draw(list.background, glm::mat3(camera.world_from_camera), sky_lens, options.background);
  gl.DepthMask(GL_TRUE);
  state_->surfaces->prepare(list, camera, lens, options);
  const auto between = [&] {
    occlude(lens, bounds, options);
    state_->surfaces->draw(list, camera, lens, options, *state_->splats, statistics);
    state_->splats->draw(list, camera, lens, options, statistics);
    const bool any_opaque = statistics.draw_calls > 0,
               behind = are_gaussians_behind_volumes(list, glm::dvec3(camera.world_from_camera[3]));
    if (const auto overlap = state_->gaussians->overlap(list, camera, lens, options, statistics))
      return state_->volumes->draw(list, camera, lens, options, statistics, &*overlap);
    if (behind) state_->gaussians->draw(list, camera, lens, options, statistics, any_opaque);
    state_->volumes->draw(list, camera, lens, options, statistics);
    if (!behind) state_->gaussians->draw(list, camera, lens, options, statistics, any_opaque);
  };
  state_->meshes->draw(list, camera, lens, options, statistics, between, state_->surfaces.get());
  if (options.guides && !statistics.given_up) {
    DrawOptions plain = options;
    plain.display = DisplayMode::surface;
    FrameStatistics of_guides;
    state_->meshes->draw(
        *options.guides, camera, lens, plain, of_guides, [] {}, nullptr);
  }
  if (list.overlays && !statistics.given_up) draw_overlays(list, perspective, options, statistics);
  // Restore the default state for other code, such as the user interface.
  if (reversed) gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  gl.DepthFunc(GL_LESS);
  gl.BindVertexArray(0);
  gl.UseProgram(0);
  gl.BindSampler(0, 0);
  gl.Disable(GL_SCISSOR_TEST);
  gl.Disable(GL_DEPTH_TEST);
  return statistics;
}

/// Darkens the opaque meshes that are drawn so far, if the options request it.
void Renderer::occlude(const Projection& lens, const WideBox& bounds, const DrawOptions& options) {
  constexpr double kReach = 0.04;  // fraction of the diagonal of the scene
  const bool wanted =
      options.occlusion == Occlusion::always || (options.occlusion == Occlusion::hardware && !state_->gl.software);
  if (!wanted || options.display != DisplayMode::surface || bounds.empty() || options.x != 0 || options.y != 0) return;
  if (!state_->occlusion) state_->occlusion.emplace(state_->gl);
  const auto radius = static_cast<float>(kReach * glm::length(glm::dvec3(bounds.upper) - glm::dvec3(bounds.lower)));
  state_->occlusion->draw(lens, {options.width, options.height}, radius);
}

// Draws overlays with their own depth range, in front of all other items.
void Renderer::draw_overlays(const RenderList& list, const Camera& given, const DrawOptions& options,
                             FrameStatistics& statistics) {
  WideBox bounds;
  for (const DrawItem& item : list.items)
    if (item.overlay && item.mesh) bounds.add(world_bounds(item.mesh->bounds, item.world_from_node));
  const bool reversed = state_->gl.ClipControl != nullptr;
  const Camera camera = fit_depth(given, bounds, reversed);
  const Projection lens =
      projection(camera, static_cast<float>(options.width), static_cast<float>(options.height), reversed);
  const float farthest = lens.farthest_depth();
  state_->gl.DepthMask(GL_TRUE);
  state_->gl.ClearBufferfv(GL_DEPTH, 0, &farthest);
  state_->meshes->draw(
      list, camera, lens, options, statistics, [] {}, state_->surfaces.get(), true);
}

/// Draws off screen and leaves the image bound for reading. Returns false with nothing bound if the driver has too
/// little memory.
bool Renderer::draw_off_screen(const RenderList& list, const Camera& camera, const DrawOptions& local,
                               FrameStatistics* statistics) {
  if (!bind_target(local.width, local.height, std::min(local.samples, local.target_samples))) {
    state_->gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    return false;
  }
  const FrameStatistics drawn = draw_in_target(list, camera, local);
  if (statistics) *statistics = drawn;
  resolve(local.width, local.height);
  return true;
}

std::variant<Image, ContextError> Renderer::draw_to_image(const RenderList& list, const Camera& camera,
                                                          const DrawOptions& options, FrameStatistics* statistics) {
  const Gl& gl = state_->gl;
  const int most = gl.max_renderbuffer_size;
  if (options.width < 1 || options.height < 1 || options.width > most || options.height > most)
    return ContextError{"a picture of " + std::to_string(options.width) + "x" + std::to_string(options.height) +
                        " pixels cannot be drawn; expected sides from 1 to " + std::to_string(most)};
  const DrawOptions local = for_target(gl, list, options, true);
  if (!draw_off_screen(list, camera, local, statistics))
    return ContextError{"the driver has no memory for a picture of " + std::to_string(local.width) + "x" +
                        std::to_string(local.height)};
  Image image = read_back(gl, local.width, local.height, local.pixel_side);
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
  return image;
}

void Renderer::prepare(const DrawOptions& options) {
  // Draw a typical triangle: drivers also compile for the drawing state.
  vrml::Mesh triangle;
  triangle.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  triangle.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  triangle.indices = {0, 1, 2};
  for (const glm::vec3& position : triangle.positions) triangle.bounds.add(position);
  RenderList list;
  list.bounds = triangle.bounds;
  DrawItem item;
  item.mesh = std::make_shared<const vrml::Mesh>(std::move(triangle));
  list.items.push_back(std::move(item));
  Camera camera;
  camera.world_from_camera[3] = {0, 0, 500, 1};  // at this distance the triangle covers only a few pixels
  const Gl& gl = state_->gl;
  const int most = gl.max_renderbuffer_size;
  if (options.width < 1 || options.height < 1 || options.width > most || options.height > most) return;
  const DrawOptions local = for_target(gl, list, options, true);
  if (!draw_off_screen(list, camera, local, nullptr)) return;
  (void)read_back(gl, local.pixel_side, local.pixel_side, local.pixel_side);  // many drivers draw only on a read
  gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

void Renderer::measure(PhaseClock* phases) { state_->gl.phases = phases; }

const std::string& Renderer::gl_renderer() const { return state_->gl.renderer; }

int Renderer::largest_side() const { return state_->gl.max_renderbuffer_size; }

}  // namespace gs::render
