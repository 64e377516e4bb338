#pragma once

#include "qnv/surface/surface_cut.h"
#include "render/gl/gpu.h"
#include "render/scene/camera.h"
#include "render/scene/draw_options.h"
#include "render/scene/render_list.h"
#include "render/splat/splat_pass.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Draws the displaced surfaces of a RenderList: takes a cut of each for every view, whose triangles MeshPass draws
/// with OpenGL, or which are rasterised here on the processor where OpenGL itself is software, as DrawOptions::splats
/// says.
class SurfacePass {
 public:
  explicit SurfacePass(const Gl& gl) : gl_(gl) {}

  /// Takes the cuts of a view; before `mesh_of` and `draw`.
  void prepare(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options);
  /// What MeshPass draws of an item whose surface has patches; null: nothing.
  [[nodiscard]] const std::shared_ptr<const vrml::Mesh>* mesh_of(const DrawItem& item) const;
  /// Draws what MeshPass does not, against the depth of what has been drawn. Leaves blending and the depth test off.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            SplatPass& shading, FrameStatistics& statistics);

 private:
  /// The last cut of a surface for a viewport that shows it, for as long as neither changes.
  struct Kept {
    std::weak_ptr<const qnv::SurfacePatches> surface;
    qnv::LodView view;
    qnv::SurfaceCut cut;
    std::shared_ptr<const vrml::Mesh> mesh;  // once OpenGL draws it
  };
  using Key = std::tuple<const qnv::SurfacePatches*, std::uint32_t, std::uint32_t>;  // which of several in the viewport
  struct OnProcessor {
    const DrawItem* item;
    const Kept* kept;
    SplatView view;
  };

  const Gl& gl_;
  std::map<Key, Kept> kept_;
  std::unordered_map<const DrawItem*, const Kept*> by_gl_;
  std::vector<OnProcessor> on_processor_;
};

}  // namespace gs::render
