#pragma once

#include "base/budget.h"
#include "base/phases.h"
#include "qnv/base/geometry.h"
#include "render/image/image.h"
#include "render/scene/layered_material.h"
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

/// Roles of nodes on which meshes depend.
inline constexpr vrml::Role kGeometryParts =
    vrml::Role::geometry | vrml::Role::geometric_property | vrml::Role::font_style;

/// Cache of the meshes of geometries and the images of PixelTextures of one world. Clear it with the world. One thread
/// at a time.
///
/// The cache does not observe geometries: call `forget` after a change. Images of PixelTextures follow their field
/// without a call.
struct MeshCache {
  struct FinerMeshes;
  struct Entry {
    std::shared_ptr<const vrml::Mesh> mesh;
    Share share;                              // part of the budget for meshes
    const vrml::SceneGraph* scene = nullptr;  // scene of the geometry node
    bool texture_coordinates = false;         // the mesh has texture coordinates
    bool refused = false;                     // the budget for meshes does not permit all of the mesh
    bool stale = false;                       // the nodes have changed after the mesh was made or `job` was submitted
    std::shared_ptr<MeshJob> job;             // job that makes the next mesh; may be null
    std::unique_ptr<FinerMeshes> finer;       // finer levels, for a Text
  };
  struct FinerMeshes {
    std::array<Entry, vrml::kTextTolerances.size() - 1> levels;
  };
  /// Stores a mesh in the entry. Stores an empty mesh if the budget does not permit it.
  static void keep(Entry& entry, std::shared_ptr<vrml::Mesh> mesh, const std::shared_ptr<Budget>& budget);

  struct PixelEntry {
    vrml::PixelImage source;  // shares memory with the field until the field changes
    std::shared_ptr<const Image> image;
    Share share;
  };
  std::unordered_map<const vrml::Node*, Entry> meshes;             // by geometry node; of a Text, the coarsest level
  std::unordered_map<const vrml::Node*, PixelEntry> pixel_images;  // by PixelTexture node
  /// Volume of a PixelTexture3D or a ComposedTexture3D.
  struct VolumeEntry {
    vrml::MFInt32 source;                              // of a PixelTexture3D
    std::vector<std::shared_ptr<const Image>> slices;  // of a ComposedTexture3D
    std::uint64_t version = 0;                         // sum of the versions of the slices
    std::shared_ptr<const Image> image;
    Share share;
  };
  std::unordered_map<const vrml::Node*, VolumeEntry> volumes;
  /// Part of the budget for the renderer's copies of a volume of X3D: values and gradients.
  struct CastEntry {
    std::weak_ptr<const Image> image;
    Share share;
  };
  std::unordered_map<const Image*, CastEntry> casts;
  std::unordered_map<const vrml::Node*, std::shared_ptr<SceneCube>> scene_cubes;  // by GeneratedCubeMapTexture
  /// Meshes of Boxes, Cones, Cylinders and Spheres with default sizes, by type, flags and level of detail. Thousands of
  /// primitives share one mesh, with different scales, and so one draw call.
  std::unordered_map<std::string, std::shared_ptr<const vrml::Mesh>> primitives;

  /// Meshes of a geometry with triangles. Valid while the geometry exists.
  struct SurfaceEntry {
    std::weak_ptr<const qnv::Geometry> geometry;
    std::array<std::shared_ptr<const vrml::Mesh>, 2> meshes;  // [1]: part with a texture
  };
  std::unordered_map<const qnv::Geometry*, SurfaceEntry> surfaces;
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> surface_of(const std::shared_ptr<const qnv::Geometry>& geometry,
                                                             bool pictured);

  /// Makes large changed meshes on a worker thread, while the old meshes stay visible. If null, meshes are made at
  /// once.
  std::shared_ptr<LateMeshes> late;
  PhaseClock* phases = nullptr;  // measures the time of tessellation; may be null

  /// Reports that a geometry has changed, or a node in its fields (Coordinate, Color, FontStyle, ...).
  void forget(const vrml::Node* node);
  /// Reports that parts of geometries, such as coordinates or colours, were added to a scene.
  void forget_scene(const vrml::SceneGraph& scene);
  /// Forgets a node of `scene`. Call it before the node is removed, because its address may be reused.
  void remove(const vrml::SceneGraph& scene, const vrml::Node* node);
  /// Records the nodes on which a geometry depends. Call it after its mesh was made.
  void made(const vrml::Node* geometry);
  /// Moves all entries of another cache, for other scenes, into this cache.
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

  std::set<std::pair<const vrml::Node*, const vrml::Node*>> geometries_of_;  // node, and geometry that uses it
  std::vector<const vrml::Node*> unlisted_;  // geometries to add to geometries_of_ when it is needed
};

}  // namespace gs::render
