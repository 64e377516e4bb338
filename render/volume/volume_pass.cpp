#include "render/volume/volume_pass.h"

#include "qnv/codecs/shared/chunk_requests.h"
#include "qnv/codecs/shared/volume_detail.h"
#include "qnv/sampling/volume/volume_values.h"
#include "render/splat/splat_budget.h"
#include "render/splat/splat_pieces.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

namespace gs::render {
namespace {

constexpr double kShareSteps = 8;               // steps per octave
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
  return volume && (!volume->empty() || volume->detail);
}

// Returns what a view needs of a stream. `transfer` is the table of the style's transfer function, if it has one.
qnv::VolumeNeeds volume_needs(const SplatItem& item, const SplatStyle& look, const VolumeTransfer& transfer,
                              const std::optional<glm::vec4>& clip) {
  qnv::VolumeNeeds needs;
  needs.values = look.reading.values;
  needs.exact = look.reading.exact;
  needs.only_slices = look.reading.only_slices;
  needs.clip = clip.value_or(glm::vec4(0));
  for (std::size_t i = 0; i < std::min(needs.slices.size(), look.reading.slices.size()); ++i)
    needs.slices[i] = glm::vec4(look.reading.slices[i] * item.world_from_node);
  if (!look.reading.points.empty()) {
    const glm::dmat4 node_from_world = glm::inverse(item.world_from_node);
    for (std::size_t i = 0; i < std::min(needs.points.size(), look.reading.points.size()); ++i)
      needs.points[i] = glm::vec3(node_from_world * glm::dvec4(look.reading.points[i], 1));
  }
  if (!look.transfer.empty()) {
    std::bitset<256>& hidden = needs.hidden_classes.emplace();
    for (std::size_t i = 0; i < transfer.size(); ++i) hidden[i] = !(transfer[i].w > 0);
  }
  return needs;
}

}  // namespace

VolumePass::VolumePass(const Gl& gl, SortMethod sort) : gl_(gl), volume_gl_(gl, sort), target_(gl), overlay_(gl) {}

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

// Notes the view for the requests of a stream. Returns finer vectors for it, or null.
std::shared_ptr<const qnv::Volume> VolumePass::cut(const qnv::Volume& volume, const SplatItem& item, SplatView view,
                                                   const glm::mat4& camera_from_node,
                                                   const std::optional<glm::vec4>& clip, const DrawOptions& options,
                                                   Scene& scene) {
  if (!volume.detail && !volume.requests) return nullptr;
  view.camera_from_node = camera_from_node;
  auto lod = lod_view(view);
  if (!lod) return nullptr;
  lod->error_pixels = 1 / item.detail;
  // Pictures with a lower resolution while something moves or loads do not change what the view needs.
  lod->pixels *= std::max(options.coarseness, 1.0f);
  // Each instance of a stream keeps its own view.
  lod->viewport = options.viewport + (scene.instances[volume.requests.get()]++ << 16);
  lod->most_decoded = options.most_decoded;
  lod->volume = volume_needs(item, options.splat_style, scene.transfer, clip);
  if (volume.values) lod->volume.step = volume.values->step;
  if (volume.detail) return volume.detail->cut(*lod, scene.working);
  volume.requests->note(*lod);
  return nullptr;
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
    auto volume = qnv::shared_as<qnv::Volume>(item.geometry);
    const glm::mat4 camera_from_node(camera_from_world * item.world_from_node);
    // A volume is clipped by one plane: the viewer's, or the outermost ClipPlane.
    std::optional<glm::vec4> clip;
    if (look.clip)
      clip = glm::vec4(*look.clip * item.world_from_node);
    else if (!item.clip_planes.empty() && item.clip_planes[0] < list.clip_planes.size())
      clip = glm::vec4(list.clip_planes[item.clip_planes[0]] * item.world_from_node);
    if (auto finer = cut(*volume, item, view, camera_from_node, clip, options, scene)) volume = std::move(finer);
    if (volume->empty() || item.material.transparency >= 1) continue;
    const std::size_t size = volume->size(), share = list.splats.size() > 1 ? steady(shares[i]) : shares[i];
    const VolumePrefix prefix = volume_prefix(size, share >= size ? 0 : share);
    auto model = model_of(volume, prefix.counted);
    if (model->empty()) continue;
    const Box& box = volume->description.box;
    const glm::vec3 middle = box.empty() ? volume->positions.front() : (box.lower + box.upper) * 0.5f;
    const glm::vec3 center(camera_from_node * glm::vec4(middle, 1));
    VolumeOptions own;
    own.opacity = look.opacity * (1 - item.material.transparency);
    own.least_magnitude = look.least_magnitude;
    if (clip) own.clip = *clip;
    own.color_by = look.color_by;
    if (!look.transfer.empty()) own.transfer = &scene.transfer;
    own.fog = camera_fog(list.fog, glm::transpose(glm::mat3(camera_from_world)), static_cast<float>(camera.back));
    own.lights = scene.lights.emplace_back(volume_lights(list, item, camera_from_world, center, options.headlight));
    scene.items.push_back({volume.get(), model.get(), camera_from_node, prefix.shown, own});
    scene.held.push_back({volume, std::move(model)});
  }
}

void VolumePass::on_processor(const Scene& scene, const SplatView& view, const Projection& projection,
                              const DrawOptions& options, FrameStatistics& statistics, const Overlap* overlap) {
  statistics.splats = "cpu";
  const TargetRectangle rectangle{options.x, options.y, options.width, options.height};
  VolumeStops stops;
  if (target_.read_depths(rectangle, projection, depths_)) stops = depths_.stops();
  const LayerRaster volumes = [&](const SplatView& part, const VolumeStops& limits) {
    return rasterize_volumes(scene.items, part, limits);
  };
  const VolumeLayer layer = overlap ? rasterize_together({volumes, overlap->rasterize}, view, stops,
                                                         overlap->shared.range, overlap->shared.slabs)
                                    : volumes(view, stops);
  statistics.vectors += layer.vectors;
  if (layer.empty()) return;
  overlay_.draw(layer, stops, projection, options);
  ++statistics.draw_calls;
}

void VolumePass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                      const DrawOptions& options, FrameStatistics& statistics, const Overlap* overlap) {
  forget_models();
  volume_gl_.forget_unused();
  if (std::none_of(list.splats.begin(), list.splats.end(), is_volume)) return;
  SplatView view = viewport_view(camera, projection, options);
  Scene scene;
  gather(list, camera, whole_view(view, camera), options, scene);
  statistics.working = statistics.working || scene.working;
  if (scene.items.empty() && !overlap) return;
  const bool with_gl = options.splats == SplatPath::gl || (options.splats == SplatPath::automatic && !gl_.software);
  if (with_gl && (!overlap || overlap->with_gl)) {
    const VolumeGl::View gl_view{
        view, projection, {options.x, options.y, options.width, options.height}, options.viewport};
    if (const auto volumes = volume_gl_.prepare(scene.held, scene.items, gl_view)) {
      if (overlap)
        target_.blend(
            gl_view.rectangle, projection,
            parts_in_slabs({&*volumes, &overlap->prepared}, depth_slabs(overlap->shared.range, overlap->shared.slabs)),
            overlap->gain);
      else if (volumes->total > 0)
        target_.blend(gl_view.rectangle, projection, growing_parts(*volumes));
      statistics.vectors += volumes->found.vectors + (overlap ? overlap->prepared.found.vectors : 0);
      statistics.pending = statistics.pending || volumes->found.pending || (overlap && overlap->prepared.found.pending);
      // Report OpenGL, unless the CPU has already drawn a volume of this frame.
      if (std::string_view(statistics.splats) == "none") statistics.splats = "gl";
      ++statistics.draw_calls;
      return;
    }
  }
  on_processor(scene, view, projection, options, statistics, overlap);
}

}  // namespace gs::render
