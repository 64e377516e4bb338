#pragma once

#include "qnv/codecs/displaced/tessellation/surface_cut.h"
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

/// Draws the displaced surfaces of a RenderList. Takes a cut of each surface for each view. MeshPass draws the
/// triangles with OpenGL. If OpenGL is a software driver, or DrawOptions::splats selects the CPU, this class rasterizes
/// them.
class SurfacePass {
 public:
  explicit SurfacePass(const Gl& gl) : gl_(gl) {}

  /// Computes the cuts for a view. Call it before `mesh_of` and `draw`.
  void prepare(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options);
  /// Returns the mesh that MeshPass must draw for an item with patches. Returns null if this class draws the item, or
  /// if it has no patches.
  [[nodiscard]] const std::shared_ptr<const vrml::Mesh>* mesh_of(const DrawItem& item) const;
  /// Draws the surfaces that MeshPass does not draw. Tests them against the existing depth. Leaves blending and the
  /// depth test off.
  void draw(const RenderList& list, const Camera& camera, const Projection& projection, const DrawOptions& options,
            SplatPass& shading, FrameStatistics& statistics);

 private:
  /// Last cut of a surface for a viewport. Reused if surface and view do not change.
  struct Kept {
    std::weak_ptr<const qnv::SurfacePatches> surface;
    qnv::LodView view;
    qnv::SurfaceCut cut;
    std::shared_ptr<const vrml::Mesh> mesh;  // null until OpenGL draws this cut
  };
  // Surface, viewport, and index of the instance in the viewport.
  using Key = std::tuple<const qnv::SurfacePatches*, std::uint32_t, std::uint32_t>;
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
