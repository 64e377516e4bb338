#include "render/gaussians/gaussian_pass.h"

#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/shared/chunk_requests.h"
#include "render/gaussians/gaussian_overlap.h"
#include "render/gaussians/gaussian_raster.h"
#include "render/splat/splat_budget.h"
#include "render/splat/splat_pieces.h"

#include <glm/glm.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

/// Gaussians of one image. held[i] owns the data of items[i].
struct GaussianScene {
  std::vector<std::shared_ptr<const qnv::Gaussians>> held;
  std::vector<GaussianItem> items;
  bool pending = false;  // the next image of this view will differ
  bool working = false;  // another thread prepares more detail

  void note(FrameStatistics& statistics) const {
    statistics.pending = statistics.pending || pending;
    statistics.working = statistics.working || working;
    for (const GaussianItem& item : items) statistics.gaussians += item.count;
  }
};

namespace {

// Number of vectors that take as long to decode as one Gaussian.
constexpr std::size_t kDecodingCost = 8;

const qnv::Gaussians* gaussians_of(const SplatItem& item) {
  const auto* gaussians = item.geometry ? item.geometry->as<qnv::Gaussians>() : nullptr;
  return gaussians && !gaussians->nothing() ? gaussians : nullptr;
}

/// Collects the Gaussians of an image.
class GaussianCollector {
 public:
  /// `with_gl` means that OpenGL draws the image.
  GaussianCollector(const Gl& gl, const RenderList& list, const Camera& camera, const DrawOptions& options,
                    const SplatView& view, GaussianLevels& levels, bool with_gl)
      : gl_(gl),
        levels_(levels),
        with_gl_(with_gl),
        list_(list),
        options_(options),
        camera_from_world_(camera_from_world_of(camera)),
        whole_(whole_view(view, camera)),
        back_(static_cast<float>(camera.back)),
        decodable_(options.most_decoded) {}

  GaussianScene collect() {
    const BudgetView budgeted = budget_view(whole_, camera_from_world_);
    std::vector<std::size_t> shares = share_budget(list_.splats, budgeted, options_.budget);
    if (options_.most_gaussians > 0) {
      const std::vector<std::size_t> moving = share_budget(list_.splats, budgeted, options_.most_gaussians);
      for (std::size_t i = 0; i < shares.size(); ++i)
        shares[i] = shares[i] == 0 ? moving[i] : std::min(shares[i], moving[i]);
    }
    for (const SplatItem& item : list_.splats)
      if (const qnv::Gaussians* gaussians = gaussians_of(item); gaussians && gaussians->stream) ++streams_;
    for (std::size_t i = 0; i < list_.splats.size(); ++i) {
      const SplatItem& item = list_.splats[i];
      const qnv::Gaussians* gaussians = gaussians_of(item);
      if (!gaussians) continue;
      if (gaussians->stream)
        add_cut(item, *gaussians->stream, shares[i]);
      else
        add_all(item, *gaussians, shares[i]);
    }
    return std::move(scene_);
  }

 private:
  /// Returns the properties of an item without its Gaussians.
  [[nodiscard]] GaussianItem item_of(const SplatItem& item) const {
    GaussianItem own;
    own.camera_from_node = glm::mat4(camera_from_world_ * item.world_from_node);
    own.opacity = 1 - item.material.transparency;
    // As volumes, Gaussians are clipped by one plane: the viewer's, or the outermost ClipPlane.
    if (options_.splat_style.clip)
      own.clip = glm::vec4(*options_.splat_style.clip * item.world_from_node);
    else if (!item.clip_planes.empty() && item.clip_planes[0] < list_.clip_planes.size())
      own.clip = glm::vec4(list_.clip_planes[item.clip_planes[0]] * item.world_from_node);
    own.fog = camera_fog(list_.fog, glm::transpose(glm::mat3(camera_from_world_)), back_);
    return own;
  }

  /// Returns the view of the whole image for a cut of an item. Returns nullopt if it is not finite.
  [[nodiscard]] std::optional<qnv::LodView> view_of(const SplatItem& item, const void* stream, std::size_t budget) {
    SplatView view = whole_;
    view.camera_from_node = glm::mat4(camera_from_world_ * item.world_from_node);
    auto lod = lod_view(view);
    if (!lod) return lod;
    lod->budget = budget;
    lod->error_pixels = options_.splat_error / std::max(item.detail, 1e-6f);
    // Each instance of a stream keeps its own level of detail.
    lod->viewport = options_.viewport + (shown_[stream]++ << 16);
    return lod;
  }

  void add_all(const SplatItem& item, const qnv::Gaussians& gaussians, std::size_t budget) {
    if (gaussians.requests)
      if (const auto view = view_of(item, gaussians.requests.get(), budget)) gaussians.requests->note(*view);
    auto shared = qnv::shared_as<qnv::Gaussians>(item.geometry);
    if (options_.time)
      if (auto view = view_of(item, &gaussians, budget)) {
        if (options_.most_decoded > 0)
          view->most_decoded = std::max<std::size_t>(options_.most_decoded / kDecodingCost, 1);
        // A GPU is usually fast enough. So with OpenGL, levels start only with a slow motion.
        if (const auto* runs =
                levels_.cut(shared, {*view, options_.splat_error, *options_.time, options_.fade, list_.budget},
                            !with_gl_, scene_.pending))
          return add_runs(item, *runs);
      }
    scene_.held.push_back(std::move(shared));
    GaussianItem& own = scene_.items.emplace_back(item_of(item));
    own.gaussians = &gaussians;
    own.count = gaussians.size();
  }

  /// Adds the cut of a stream. Takes it for the whole image, so that tiles of the image match.
  void add_cut(const SplatItem& item, qnv::SplatStream& stream, std::size_t budget) {
    const PhaseScope phase(gl_.phases, Phase::cut);
    auto lod = view_of(item, &stream, budget);
    if (!lod) return;
    if (options_.most_decoded > 0)
      lod->most_decoded = std::max<std::size_t>(decodable_ / (kDecodingCost * streams_--), 1);
    const std::vector<qnv::SplatRun>& runs = stream.cut(*lod, options_.time, options_.fade);
    decodable_ -= std::min(decodable_, kDecodingCost * stream.statistics().decoded);
    scene_.pending = scene_.pending || stream.pending() || stream.fading();
    scene_.working = scene_.working || stream.repairing();
    add_runs(item, runs);
  }

  void add_runs(const SplatItem& item, const std::vector<qnv::SplatRun>& runs) {
    GaussianItem own = item_of(item);
    for (const qnv::SplatRun& run : runs) {
      own.gaussians = run.splats.get();
      own.first = run.first;
      own.count = run.count;
      own.presence = run.presence;
      scene_.held.push_back(run.splats);
      scene_.items.push_back(own);
    }
  }

  const Gl& gl_;
  GaussianLevels& levels_;
  bool with_gl_;
  const RenderList& list_;
  const DrawOptions& options_;
  glm::dmat4 camera_from_world_;
  SplatView whole_;
  float back_;
  std::size_t decodable_, streams_ = 0;
  std::unordered_map<const void*, std::uint32_t> shown_;  // number of instances of each stream so far
  GaussianScene scene_;
};

}  // namespace

GaussianPass::GaussianPass(const Gl& gl, SortMethod sort)
    : gl_(gl), target_(gl), gaussian_gl_(gl, sort), overlay_(gl) {}

GaussianPass::~GaussianPass() = default;

std::shared_ptr<const GaussianScene> GaussianPass::collect(const RenderList& list, const Camera& camera,
                                                           const DrawOptions& options, const SplatView& view) {
  return std::make_shared<const GaussianScene>(
      GaussianCollector(gl_, list, camera, options, view, levels_, with_gl(options)).collect());
}

bool GaussianPass::with_gl(const DrawOptions& options) const {
  return options.splats == SplatPath::gl || (options.splats == SplatPath::automatic && !gl_.software);
}

std::optional<VolumePass::Overlap> GaussianPass::overlap(const RenderList& list, const Camera& camera,
                                                         const Projection& projection, const DrawOptions& options,
                                                         FrameStatistics& statistics) {
  collected_ = nullptr;
  if (!do_boxes_of_gaussians_and_volumes_overlap(list)) return std::nullopt;
  levels_.forget_unused();
  const SplatView view = viewport_view(camera, projection, options);
  auto scene = collect(list, camera, options, view);
  const auto shared = shared_depths(scene->items, volume_boxes(list, camera), view);
  if (!shared) {
    collected_ = std::move(scene);
    return std::nullopt;
  }
  scene->note(statistics);
  VolumePass::Overlap made;
  made.shared = *shared;
  made.gain = kGaussianLayerGain;
  made.rasterize = [scene](const SplatView& part, const VolumeStops& stops) {
    return rasterize_gaussians(scene->items, part, stops, false);
  };
  if (!with_gl(options)) return made;
  gaussian_gl_.forget_unused();
  const TargetRectangle rectangle{options.x, options.y, options.width, options.height};
  if (auto prepared =
          gaussian_gl_.prepare(scene->held, scene->items, {view, projection, rectangle, options.viewport})) {
    made.prepared = std::move(*prepared);
    made.with_gl = true;
  }
  return made;
}

void GaussianPass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                        const DrawOptions& options, FrameStatistics& statistics, bool any_opaque) {
  gaussian_gl_.forget_unused();
  levels_.forget_unused();
  if (std::none_of(list.splats.begin(), list.splats.end(), gaussians_of)) return note_picture_without_gaussians();
  const SplatView view = viewport_view(camera, projection, options);
  const TargetRectangle rectangle{options.x, options.y, options.width, options.height};
  std::shared_ptr<const GaussianScene> collected = std::exchange(collected_, nullptr);
  if (!collected) collected = collect(list, camera, options, view);
  const GaussianScene& scene = *collected;
  scene.note(statistics);
  if (with_gl(options)) {
    if (const auto splats =
            gaussian_gl_.prepare(scene.held, scene.items, {view, projection, rectangle, options.viewport})) {
      if (splats->total > 0) target_.blend(rectangle, projection, growing_parts(*splats), kGaussianLayerGain);
      statistics.vectors += splats->found.vectors;
      statistics.pending = statistics.pending || splats->found.pending;
      if (std::string_view(statistics.splats) == "none") statistics.splats = "gl";
      ++statistics.draw_calls;
      return;
    }
    statistics.splats = "cpu";  // shows that OpenGL could not draw splats
  }
  VolumeStops stops;
  const bool is_read = any_opaque && target_.read_depths(rectangle, projection, depths_);
  if (is_read) stops = depths_.stops();
  const VolumeLayer layer = rasterize_gaussians(scene.items, view, stops, any_opaque && !is_read);
  if (std::string_view(statistics.splats) == "none") statistics.splats = "cpu";
  statistics.vectors += layer.vectors;
  if (layer.empty()) return;
  overlay_.draw(layer, stops, projection, options);
  ++statistics.draw_calls;
}

}  // namespace gs::render
