#include "render/volume/volume_pass.h"

#include "render/gl/shaders.h"
#include "render/splat/splat_budget.h"
#include "render/volume/volume_shaders.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <variant>

namespace gs::render {
namespace {

constexpr double kShareSteps = 8;  // steps per octave
constexpr std::uint64_t kKeptModelFrames = 64;  // frames for which a model is kept although its prefix is not drawn

/// Rounds a share down to a step. Shares change with each movement of the viewer; the number of drawn vectors should
/// not.
std::size_t steady(std::size_t share) {
  if (share < 2) return share;
  return static_cast<std::size_t>(
      std::exp2(std::floor(std::log2(static_cast<double>(share)) * kShareSteps) / kShareSteps));
}

bool is_volume(const SplatItem& item) {
  const auto* volume = item.geometry ? item.geometry->as<qnv::Volume>() : nullptr;
  return volume && !volume->empty();
}

/// Returns depths in window space for compositing a layer; -1 means no depth test. If the samples of a pixel differ in
/// depth, the result is between their depths. Without stops, it is the depth at which the pixel becomes opaque.
std::vector<float> window_depths(const VolumeLayer& layer, const VolumeStops& stops, const Projection& projection) {
  std::vector<float> depths(layer.depth.size(), -1.0f);
  const auto window = [&](float depth) {
    const float at = projection.window_depth(depth);
    return at > 0 ? std::min(at, 1.0f) : 0.0f;
  };
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (stops.near.empty()) {
      if (layer.depth[i] > 0) depths[i] = window(layer.depth[i]);
    } else if (!layer.edge_pixels.empty() && stops.near[i] != stops.far[i]) {
      depths[i] = 0.5f * (window(stops.near[i]) + window(stops.far[i]));
    }
  }
  return depths;
}

}  // namespace

VolumePass::VolumePass(const Gl& gl, VolumeSort sort)
    : gl_(gl),
      volume_gl_(gl, sort),
      target_(gl),
      no_attributes_(make_vertex_array(gl)),
      pixels_texture_(make_texture(gl)),
      depths_texture_(make_texture(gl)) {
  for (const Texture* texture : {&pixels_texture_, &depths_texture_}) {
    gl.BindTexture(GL_TEXTURE_2D, texture->name());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  }
  overlay_ = make_overlay("");
  edge_overlay_ = make_overlay("#define EDGES\n");
}

VolumePass::Overlay VolumePass::make_overlay(const char* defines) const {
  Overlay overlay;
  auto made = make_program(gl_, defines, kScreenVertexShader, kVolumePixelsFragmentShader);
  auto* program = std::get_if<Program>(&made);
  if (!program) return overlay;
  overlay.program = std::move(*program);
  overlay.pixels = gl_.GetUniformLocation(overlay.program.name(), "pixels");
  overlay.depths = gl_.GetUniformLocation(overlay.program.name(), "depths");
  overlay.origin = gl_.GetUniformLocation(overlay.program.name(), "origin");
  overlay.nearest = gl_.GetUniformLocation(overlay.program.name(), "nearest");
  return overlay;
}

std::shared_ptr<const VolumeModel> VolumePass::model_of(const std::shared_ptr<const qnv::Volume>& volume,
                                                        std::size_t counted) {
  const auto [first, last] = models_.equal_range(volume.get());
  for (auto entry = first; entry != last; ++entry) {
    if (entry->second.counted != counted) continue;
    entry->second.used = frame_;
    return entry->second.model;
  }
  auto model = std::make_shared<const VolumeModel>(volume_model(*volume, 0, counted));
  models_.emplace(volume.get(), Held{volume, counted, model, frame_});
  return model;
}

void VolumePass::forget_models() {
  ++frame_;
  std::erase_if(models_, [&](const auto& entry) {
    const Held& held = entry.second;
    const std::shared_ptr<const qnv::Volume> volume = held.volume.lock();
    return !volume || (held.counted < volume->size() && held.used + kKeptModelFrames < frame_);
  });
}

void VolumePass::gather(const RenderList& list, const Camera& camera, const SplatView& view, const DrawOptions& options,
                        Scene& scene) {
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  const std::vector<std::size_t> shares =
      share_budget(list.splats, budget_view(view, camera_from_world), options.budget);
  const SplatStyle& look = options.splat_style;
  if (!look.transfer.empty()) scene.transfer = volume_transfer({}, look.transfer);
  scene.lights.reserve(list.splats.size());  // `items` point to elements of `lights`, so these must not move
  for (std::size_t i = 0; i < list.splats.size(); ++i) {
    const SplatItem& item = list.splats[i];
    if (!is_volume(item)) continue;
    const auto volume = qnv::shared_as<qnv::Volume>(item.geometry);
    const std::size_t size = volume->size(), share = list.splats.size() > 1 ? steady(shares[i]) : shares[i];
    const VolumePrefix prefix = volume_prefix(size, share >= size ? 0 : share);
    auto model = model_of(volume, prefix.counted);
    if (model->empty()) continue;
    const Box& box = volume->description.box;
    const glm::vec3 middle = box.empty() ? volume->positions.front() : (box.lower + box.upper) * 0.5f;
    const glm::mat4 camera_from_node(camera_from_world * item.world_from_node);
    const glm::vec3 center(camera_from_node * glm::vec4(middle, 1));
    VolumeOptions own;
    own.opacity = look.opacity * (1 - item.material.transparency);
    own.least_magnitude = look.least_magnitude;
    // A volume is clipped by one plane: the viewer's, or the outermost ClipPlane.
    if (look.clip)
      own.clip = glm::vec4(*look.clip * item.world_from_node);
    else if (!item.clip_planes.empty() && item.clip_planes[0] < list.clip_planes.size())
      own.clip = glm::vec4(list.clip_planes[item.clip_planes[0]] * item.world_from_node);
    own.color_by = look.color_by;
    if (!look.transfer.empty()) own.transfer = &scene.transfer;
    own.fog = camera_fog(list.fog, glm::transpose(glm::mat3(camera_from_world)), static_cast<float>(camera.back));
    own.lights = scene.lights.emplace_back(volume_lights(list, item, camera_from_world, center, options.headlight));
    scene.items.push_back({volume.get(), model.get(), camera_from_node, prefix.shown, own});
    scene.held.push_back({volume, std::move(model)});
  }
}

void VolumePass::draw_overlay(const Overlay& overlay, const VolumeLayer& layer, const std::vector<std::uint8_t>& pixels,
                              const Projection& projection, const DrawOptions& options) {
  if (!overlay.program) return;
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindSampler(0, 0);
  gl_.BindTexture(GL_TEXTURE_2D, pixels_texture_.name());
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, layer.width, layer.height, 0, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  gl_.UseProgram(overlay.program.name());
  gl_.Uniform1i(overlay.pixels, 0);
  gl_.Uniform1i(overlay.depths, 1);
  gl_.Uniform2i(overlay.origin, options.x, options.y);
  gl_.Uniform1f(overlay.nearest, projection.nearest_depth());
  gl_.BindVertexArray(no_attributes_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
}

void VolumePass::lay_over(const VolumeLayer& layer, const std::vector<float>& depths, const Projection& projection,
                          const DrawOptions& options) {
  gl_.Viewport(options.x, options.y, options.width, options.height);
  gl_.Scissor(options.x, options.y, options.width, options.height);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.DepthFunc(projection.reversed ? GL_GEQUAL : GL_LEQUAL);
  gl_.DepthMask(GL_FALSE);
  gl_.Disable(GL_CULL_FACE);
  gl_.Enable(GL_BLEND);
  gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.ActiveTexture(GL_TEXTURE1);
  gl_.BindSampler(1, 0);
  gl_.BindTexture(GL_TEXTURE_2D, depths_texture_.name());
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, layer.width, layer.height, 0, GL_RED, GL_FLOAT, depths.data());
  draw_overlay(overlay_, layer, layer.pixels, projection, options);
  if (!layer.edge_pixels.empty()) {
    // Draw the samples of each pixel that the first draw excluded.
    gl_.DepthFunc(projection.reversed ? GL_LESS : GL_GREATER);
    draw_overlay(edge_overlay_, layer, layer.edge_pixels, projection, options);
  }
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  gl_.Disable(GL_DEPTH_TEST);
}

void VolumePass::on_processor(const Scene& scene, const SplatView& view, const Projection& projection,
                              const DrawOptions& options, FrameStatistics& statistics) {
  statistics.splats = "cpu";
  const TargetRectangle rectangle{options.x, options.y, options.width, options.height};
  VolumeStops stops;
  if (target_.read_depths(rectangle, projection, depths_)) stops = depths_.stops();
  const VolumeLayer layer = rasterize_volumes(scene.items, view, stops);
  statistics.vectors += layer.vectors;
  if (layer.empty()) return;
  lay_over(layer, window_depths(layer, stops, projection), projection, options);
  ++statistics.draw_calls;
}

void VolumePass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                      const DrawOptions& options, FrameStatistics& statistics) {
  forget_models();
  volume_gl_.forget_unused();
  if (std::none_of(list.splats.begin(), list.splats.end(), is_volume)) return;
  SplatView view = viewport_view(camera, projection, options);
  Scene scene;
  gather(list, camera, whole_view(view, camera), options, scene);
  if (scene.items.empty()) return;
  const bool with_gl = options.splats == SplatPath::gl || (options.splats == SplatPath::automatic && !gl_.software);
  if (with_gl) {
    const VolumeGl::View gl_view{
        view, projection, {options.x, options.y, options.width, options.height}, options.viewport};
    if (const auto drawn = volume_gl_.draw(scene.held, scene.items, gl_view)) {
      statistics.vectors += drawn->vectors;
      statistics.pending = statistics.pending || drawn->pending;
      // Report OpenGL, unless the CPU has already drawn a volume of this frame.
      if (std::string_view(statistics.splats) == "none") statistics.splats = "gl";
      ++statistics.draw_calls;
      return;
    }
  }
  on_processor(scene, view, projection, options, statistics);
}

}  // namespace gs::render
