#include "render/draw/renderer.h"

#include "base/parallel.h"
#include "render/collection/collector.h"
#include "render/draw/cube_pass.h"
#include "render/gl/gpu.h"
#include "render/mesh/background_pass.h"
#include "render/mesh/mesh_pass.h"
#include "render/mesh/occlusion_pass.h"
#include "render/splat/splat_pass.h"
#include "render/surface/surface_pass.h"
#include "render/volume/volume_pass.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>

namespace gs::render {

/// Off-screen framebuffer, possibly multisampled; `resolved` then has one sample per pixel. Its depth buffer is float
/// if OpenGL supports glClipControl.
struct OffscreenTarget {
  int width = 0, height = 0, samples = 0;  // requested values; the driver may give fewer samples
  Renderbuffer color, depth, resolved_color;
  Framebuffer framebuffer, resolved;
};

/// Last complete image of a viewport, with one sample per pixel.
struct FormerPicture {
  int width = 0, height = 0;
  Renderbuffer color;
  Framebuffer framebuffer;
};

namespace {

// Maximum bytes of an off-screen image. Larger images get fewer samples.
constexpr std::size_t kMaxFramebufferBytes = std::size_t{1} << 30;
constexpr std::size_t kBytesPerSample = 8;  // colour and depth
constexpr int kPixelSide = 2;               // with pixels as samples: number of samples along the side of a pixel
constexpr float kMaxCoarseness = 16;
constexpr std::size_t kLightsOfManyPixels = 8;  // with more lights, additional pixels take too long

void attach(const Gl& gl, const Renderbuffer& buffer, GLenum format, GLenum attachment, int samples, int width,
            int height) {
  gl.BindRenderbuffer(GL_RENDERBUFFER, buffer.name());
  gl.RenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, width, height);
  gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, buffer.name());
}

/// Makes a target. Its framebuffer is empty if the driver cannot make it.
OffscreenTarget make_target(const Gl& gl, int width, int height, int samples) {
  const GLenum depth = gl.ClipControl ? GL_DEPTH_COMPONENT32F : GL_DEPTH_COMPONENT24;
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
  attach(gl, target.depth, depth, GL_DEPTH_ATTACHMENT, multiple, width, height);
  if (!complete()) return {};
  if (multiple == 0) return target;
  target.resolved_color = make_renderbuffer(gl);
  target.resolved = make_framebuffer(gl);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target.resolved.name());
  attach(gl, target.resolved_color, GL_RGBA8, GL_COLOR_ATTACHMENT0, 0, width, height);
  if (!complete()) return {};
  return target;
}

/// Makes a framebuffer for an image. Its framebuffer is empty if the driver cannot make it.
FormerPicture make_picture(const Gl& gl, int width, int height) {
  take_errors(gl);
  FormerPicture picture{width, height, make_renderbuffer(gl), make_framebuffer(gl)};
  gl.BindFramebuffer(GL_FRAMEBUFFER, picture.framebuffer.name());
  attach(gl, picture.color, GL_RGBA8, GL_COLOR_ATTACHMENT0, 0, width, height);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || gl.GetError() != GL_NO_ERROR) return {};
  return picture;
}

/// Reports whether the CPU rasterizes a surface or splats of the list. Sets `nothing_else` if the CPU draws everything
/// that has edges; then OpenGL needs no multisampling.
bool draws_layers(const Gl& gl, const RenderList& list, const DrawOptions& options, bool& nothing_else) {
  const bool discs_by_gl = options.splats == SplatPath::gl || (options.splats == SplatPath::automatic && !gl.software);
  // OpenGL draws triangles that are only outlines or points.
  const bool by_gl = discs_by_gl || options.display != DisplayMode::surface;
  bool any = !list.splats.empty();
  nothing_else = !discs_by_gl && !options.guides;
  for (const DrawItem& item : list.items) {
    const bool layer = item.patches() && !item.overlay && !by_gl;
    any = any || layer;
    nothing_else = nothing_else && (layer || !item.visible);
  }
  for (const SplatItem& item : list.splats)
    nothing_else = nothing_else && item.geometry && !item.geometry->as<qnv::Volume>();
  nothing_else = nothing_else && any;
  return any;
}

/// Returns options for off-screen drawing. If `reduced`, software drivers draw four times the pixels, which are
/// averaged later: multisampling takes three times as long. Does not reduce CPU-rasterized surfaces, which have their
/// own sampling.
DrawOptions for_target(const Gl& gl, const RenderList& list, const DrawOptions& options, bool reduced) {
  DrawOptions local = options;
  local.x = local.y = 0;
  const int most = gl.max_renderbuffer_size / kPixelSide;
  bool nothing_else = false;
  const bool layers = draws_layers(gl, list, options, nothing_else);
  if (nothing_else) local.target_samples = 1;
  if (reduced && gl.software && std::min(options.samples, gl.max_samples) == kPixelSide * kPixelSide && !layers &&
      list.lights.size() <= kLightsOfManyPixels && options.width <= most && options.height <= most) {
    local.width *= kPixelSide;
    local.height *= kPixelSide;
    local.samples = 1;
    local.pixel_side = kPixelSide;
  }
  return local;
}

/// Writes the mean of a square of 2x2 RGBA pixels as one RGB pixel. Adds two components at a time.
void put_mean(const std::uint8_t* above, const std::uint8_t* below, std::uint8_t* to) {
  static_assert(std::endian::native == std::endian::little);
  constexpr std::uint32_t kEven = 0x00FF00FF, kHalf = 0x00020002;
  std::array<std::uint32_t, 4> pixels;
  std::memcpy(pixels.data(), above, 8);
  std::memcpy(pixels.data() + 2, below, 8);
  std::uint32_t even = kHalf, odd = kHalf;
  for (const std::uint32_t pixel : pixels) {
    even += pixel & kEven;
    odd += pixel >> 8 & kEven;
  }
  const std::uint32_t mean = (even >> 2 & kEven) | (odd >> 2 & kEven) << 8;
  std::memcpy(to, &mean, 3);
}

/// Reads the bound framebuffer through a pixel buffer, top row first. Each pixel of the result is the mean of `side` x
/// `side` pixels.
Image read_back(const Gl& gl, int width, int height, int side) {
  const auto columns = static_cast<std::size_t>(width / side), rows = static_cast<std::size_t>(height / side);
  const std::size_t stride = static_cast<std::size_t>(width) * 4, square = static_cast<std::size_t>(side);
  Image image{static_cast<std::uint32_t>(columns), static_cast<std::uint32_t>(rows), 3, {}};
  image.pixels.resize(columns * rows * 3);
  const auto reduce_row = [&](const std::uint8_t* from, std::uint8_t* to) {
    if (square == 2) {
      for (std::size_t x = 0; x < columns; ++x, from += 8, to += 3) put_mean(from, from + stride, to);
    } else {
      for (std::size_t x = 0; x < columns; ++x, from += 4)
        for (std::size_t c = 0; c < 3; ++c) *to++ = from[c];
    }
  };
  // Read one band at a time: a buffer for all pixels would be a second copy. Read four bytes per pixel, because drivers
  // would have to convert three.
  constexpr std::size_t kBand = 128, kRows = 32;  // rows of the image per band, and rows per task
  std::vector<std::uint8_t> pixels(stride * square * std::min(kBand, rows));
  gl.ReadBuffer(GL_COLOR_ATTACHMENT0);
  for (std::size_t first = 0; first < rows; first += kBand) {
    const std::size_t end = std::min(rows, first + kBand);
    gl.ReadPixels(0, static_cast<GLint>((rows - end) * square), width, static_cast<GLsizei>((end - first) * square),
                  GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    (void)parallel_for((end - first + kRows - 1) / kRows, [&](std::size_t task) {
      for (std::size_t y = first + task * kRows; y < std::min(end, first + (task + 1) * kRows); ++y)
        reduce_row(pixels.data() + (end - 1 - y) * square * stride, image.pixels.data() + y * columns * 3);
    });
  }
  return image;
}

}  // namespace

struct Renderer::State {
  GlContext* context = nullptr;
  Gl gl;
  std::optional<BackgroundPass> background;
  std::unique_ptr<MeshPass> meshes;
  std::unique_ptr<SplatPass> splats;
  std::unique_ptr<SurfacePass> surfaces;
  std::unique_ptr<VolumePass> volumes;
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

namespace {

/// Part of a picture that a layer fills, and the camera for it.
struct LayerPart {
  Camera camera;
  DrawOptions options;
};

/// Returns the drawn part of a layer with this clipBoundary (X3D 35.4.4); nullopt if it has no pixel. `options` are
/// those of the picture; `camera` is the layer's, with the drawn part of the picture.
std::optional<LayerPart> part_of(const vrml::ClipBoundary& boundary, const Camera& camera, const DrawOptions& options) {
  LayerPart layer{camera, options};
  const auto cut = [](double lower, double upper, double& low, double& high, int& at, int& pixels) {
    // The layer, and the drawn part of the picture, from -1 to 1 over the whole picture.
    const double first = 2 * lower - 1, last = 2 * upper - 1, scale = pixels / (high - low);
    const double begin = std::max(first, low), end = std::min(last, high);
    const int from = static_cast<int>(std::lround((begin - low) * scale)),
              to = static_cast<int>(std::lround((end - low) * scale));
    if (!(begin < end) || from >= to) return false;
    low = (begin - first) / (last - first) * 2 - 1;
    high = (end - first) / (last - first) * 2 - 1;
    at += from;
    pixels = to - from;
    return true;
  };
  PicturePart& part = layer.camera.part;
  if (!cut(boundary[0], boundary[1], part.left, part.right, layer.options.x, layer.options.width) ||
      !cut(boundary[2], boundary[3], part.bottom, part.top, layer.options.y, layer.options.height))
    return std::nullopt;
  return layer;
}

/// Returns the camera of a layer, for the part of the picture that `camera` draws.
Camera lens_of(const RenderLayer& layer, const Camera& camera, const DrawOptions& options) {
  Camera lens = layer.camera;
  lens.part = camera.part;
  if (layer.extent.x > 0) {
    const vrml::ClipBoundary& boundary = layer.list->boundary;
    const glm::dvec2 whole(whole_size(camera, glm::vec2(options.width, options.height)));
    const glm::dvec2 size(whole.x * (boundary[1] - boundary[0]), whole.y * (boundary[3] - boundary[2]));
    const double smaller = std::min(size.x, size.y);
    lens.height = std::max(layer.extent.x * smaller / size.x, layer.extent.y * smaller / size.y);
  }
  return lens;
}

/// Returns the options for a layer that is not active.
DrawOptions options_of(const RenderLayer& layer, std::size_t index, const DrawOptions& options) {
  constexpr std::uint32_t kViewports = 1u << 16;  // more than a window has: each layer has a level of detail of its own
  DrawOptions result = options;
  result.headlight = layer.list->navigation.headlight;
  result.headlight_towards = {0, 0, 1};
  result.viewport += kViewports * (static_cast<std::uint32_t>(index) + 1);
  result.guides = nullptr;
  result.unit = 1;
  return result;
}

void add_to(FrameStatistics& sum, const FrameStatistics& layer) {
  sum.triangles += layer.triangles;
  sum.items += layer.items;
  sum.draw_calls += layer.draw_calls;
  sum.vectors += layer.vectors;
  if (layer.vectors > 0) sum.splats = layer.splats;
  sum.pending = sum.pending || layer.pending;
  sum.given_up = sum.given_up || layer.given_up;
}

}  // namespace

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

/// Draws one list. If `in_front`, what is drawn before stays visible behind it, unless a Background is bound in its
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
    state_->volumes->draw(list, camera, lens, options, statistics);
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
