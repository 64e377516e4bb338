#pragma once

#include "base/budget.h"
#include "base/phases.h"
#include "qnv/base/geometry.h"
#include "render/image/image.h"
#include "vrml/mesh/mesh.h"
#include "vrml/mesh/text_shaper.h"
#include "vrml/scene/scene_graph.h"

#include <array>
#include <memory>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::render {

struct MeshJob;
class LateMeshes;

/// Roles of nodes that determine meshes.
inline constexpr vrml::Role kGeometryParts =
    vrml::Role::geometry | vrml::Role::geometric_property | vrml::Role::font_style;

/// Cache of geometries' meshes and of PixelTexture images for the lifetime of a world; clear it with the world. Used by
/// one thread at a time.
///
/// The cache does not observe meshes' nodes: `forget` reports changes. Images of PixelTextures follow their field
/// automatically.
struct MeshCache {
  struct FinerMeshes;
  struct Entry {
    std::shared_ptr<const vrml::Mesh> mesh;
    Share share;                              // from the budget for meshes
    const vrml::SceneGraph* scene = nullptr;  // of the geometry node
    bool texture_coordinates = false;         // whether they were requested
    bool refused = false;                     // the limit for meshes removed some or all of it
    bool stale = false;                       // the nodes have changed since it was made, or since `job` was submitted
    std::shared_ptr<MeshJob> job;             // makes the next mesh; null means none
    std::unique_ptr<FinerMeshes> finer;       // finer levels of a Text
  };
  struct FinerMeshes {
    std::array<Entry, vrml::kTextTolerances.size() - 1> levels;
  };
  /// Sets the mesh of the entry, or an empty one if the budget does not permit it.
  static void keep(Entry& entry, std::shared_ptr<vrml::Mesh> mesh, const std::shared_ptr<Budget>& budget);

  struct PixelEntry {
    vrml::PixelImage source;  // shares storage with the field until that changes
    std::shared_ptr<const Image> image;
    Share share;
  };
  std::unordered_map<const vrml::Node*, Entry> meshes;             // by geometry node; for Text, the coarsest level
  std::unordered_map<const vrml::Node*, PixelEntry> pixel_images;  // by PixelTexture node
  /// Boxes, cones, cylinders and spheres of default measures, by type, flags and level of detail. Worlds with thousands
  /// of primitives share one mesh with different scales, and so one draw call.
  std::unordered_map<std::string, std::shared_ptr<const vrml::Mesh>> primitives;

  /// Meshes of point sets with triangles, while the point sets exist.
  struct SurfaceEntry {
    std::weak_ptr<const qnv::Geometry> geometry;
    std::array<std::shared_ptr<const vrml::Mesh>, 2> meshes;  // second: the textured part
  };
  std::unordered_map<const qnv::Geometry*, SurfaceEntry> surfaces;
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> surface_of(const std::shared_ptr<const qnv::Geometry>& geometry,
                                                             bool pictured);

  /// Makes large changed meshes while the previous ones stay visible; null means that meshes are made on request.
  std::shared_ptr<LateMeshes> late;
  PhaseClock* phases = nullptr;  // measures tessellation time; null means none

  /// Reports a change of a geometry, or of a node that geometries use (Coordinate, Color, FontStyle, ...).
  void forget(const vrml::Node* node);
  /// Reports that parts of this scene's geometries, such as coordinates or colours, were added.
  void forget_scene(const vrml::SceneGraph& scene);
  /// Forgets a node of `scene` that is about to be removed; its address may be reused.
  void remove(const vrml::SceneGraph& scene, const vrml::Node* node);
  /// Records the dependencies of a geometry after its mesh was made.
  void made(const vrml::Node* geometry);
  /// Takes over entries of other scenes from another cache.
  void take(MeshCache&& other);
  void clear() {
    PhaseClock* const kept = phases;
    std::shared_ptr<LateMeshes> kept_late = std::move(late);
    *this = {};
    phases = kept;
    late = std::move(kept_late);
  }

 private:
  void renew(std::unordered_map<const vrml::Node*, Entry>::iterator entry);

  std::set<std::pair<const vrml::Node*, const vrml::Node*>> geometries_of_;  // by part node
  std::vector<const vrml::Node*> unlisted_;  // geometries not yet recorded there; most worlds never need it
};

}  // namespace gs::render
