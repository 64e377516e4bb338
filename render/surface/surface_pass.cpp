#include "render/surface/surface_pass.h"

#include "render/scene/surface_mesh.h"
#include "render/splat/splat_budget.h"
#include "render/splat/splat_pieces.h"
#include "render/surface/patch_raster.h"

#include <algorithm>
#include <string_view>
#include <utility>

namespace gs::render {

void SurfacePass::prepare(const RenderList& list, const Camera& camera, const Projection& projection,
                          const DrawOptions& options) {
  by_gl_.clear();
  on_processor_.clear();
  std::erase_if(kept_, [](const auto& each) { return each.second.surface.expired(); });
  std::size_t surfaces = 0;
  for (const DrawItem& item : list.items) surfaces += item.visible && item.patches() ? 1 : 0;
  if (surfaces == 0) return;
  const PhaseScope phase(gl_.phases, Phase::cut);
  const glm::dmat4 camera_from_world = camera_from_world_of(camera);
  std::unordered_map<const qnv::SurfacePatches*, std::uint32_t> shown;  // instances of each surface so far
  const bool software = options.display == DisplayMode::surface &&
                        (options.splats == SplatPath::cpu || (options.splats == SplatPath::automatic && gl_.software));
  for (const DrawItem& item : list.items) {
    const auto patches = qnv::shared_as<qnv::SurfacePatches>(item.surface);
    if (!patches || !item.visible) continue;
    SplatView view = viewport_view(camera, projection, options);
    view.supersample = options.samples > 1 ? 2 : 1;
    view.camera_from_node = glm::mat4(camera_from_world * item.world_from_node);
    // Cut for the whole image, so that its tiles match.
    auto looked = lod_view(whole_view(view, camera));
    if (!looked) continue;
    looked->budget = options.budget == 0 ? 0 : std::max<std::size_t>(options.budget / surfaces, 1);
    looked->error_pixels = static_cast<float>(options.pixel_side) / item.detail;
    looked->leave_backs = !patches->description.two_sided;
    const std::uint32_t instance = shown[patches.get()]++;
    looked->viewport = options.viewport + (instance << 16);
    if (patches->requests) patches->requests->note(*looked);
    Kept& kept = kept_[{patches.get(), options.viewport, instance}];
    if (kept.surface.lock() != patches || !(kept.view == *looked)) {
      kept = {patches, *looked, qnv::cut_surface(*patches, *looked), nullptr};
    }
    if (kept.cut.patches.empty()) continue;
    if (software && !item.overlay) {
      on_processor_.push_back({&item, &kept, view});
      continue;
    }
    if (!kept.mesh) kept.mesh = mesh_of_cut(*patches, kept.cut);
    by_gl_[&item] = &kept;
  }
}

const std::shared_ptr<const vrml::Mesh>* SurfacePass::mesh_of(const DrawItem& item) const {
  const auto found = by_gl_.find(&item);
  return found == by_gl_.end() ? nullptr : &found->second->mesh;
}

void SurfacePass::draw(const RenderList& list, const Camera& camera, const Projection& projection,
                       const DrawOptions& options, SplatPass& shading, FrameStatistics& statistics) {
  for (const OnProcessor& one : on_processor_) {
    const auto& patches = *one.item->patches();
    const PatchRasterOptions looks{patches.description.two_sided, patches.color, options.splat_style.color_by};
    const SplatLayer layer = rasterize_patches(patches, one.kept->cut, one.view, looks);
    shading.draw_layer(layer, list, *one.item, camera, projection, options);
    statistics.vectors += layer.discs;
    statistics.triangles += layer.drawn;
    ++statistics.items;
    ++statistics.draw_calls;
    if (std::string_view(statistics.splats) == "none") statistics.splats = "cpu";
  }
}

}  // namespace gs::render
