#pragma once

#include "qnv/base/cloud.h"
#include "render/base/phases.h"
#include "render/image/image.h"
#include "vrml/mesh/mesh.h"
#include "vrml/mesh/text_shaper.h"
#include "vrml/scene/budget.h"
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

/// Nodes that meshes are made of.
inline constexpr vrml::Role kGeometryParts =
    vrml::Role::geometry | vrml::Role::geometric_property | vrml::Role::font_style;

/// What is made of geometries and PixelTextures once, and kept while the world lives. Drop it with the world. One
/// thread at a time.
///
/// Meshes are not watched: `forget` tells what has changed. Images of PixelTextures follow their field by themselves.
struct MeshCache {
  struct FinerMeshes;
  struct Entry {
    std::shared_ptr<const vrml::Mesh> mesh;
    vrml::Share share;                        // of the budget for meshes
    const vrml::SceneGraph* scene = nullptr;  // of the geometry node
    bool texture_coordinates = false;         // whether they were asked for
    bool refused = false;                     // the limit for meshes took some or all of it
    bool stale = false;                  // the nodes have changed since it was made, or since `job` was handed over
    std::shared_ptr<MeshJob> job;        // makes the one that is shown next; null: none does
    std::unique_ptr<FinerMeshes> finer;  // of a Text
  };
  struct FinerMeshes {
    std::array<Entry, vrml::kTextTolerances.size() - 1> levels;
  };
  /// Makes it the mesh of the entry, or an empty one where there is no room for it.
  static void keep(Entry& entry, std::shared_ptr<vrml::Mesh> mesh, const std::shared_ptr<vrml::Budget>& budget);

  struct PixelEntry {
    vrml::PixelImage source;  // shares its storage with the field while that is unchanged
    std::shared_ptr<const Image> image;
    vrml::Share share;
  };
  std::unordered_map<const vrml::Node*, Entry> meshes;             // by geometry node; of Text the coarsest
  std::unordered_map<const vrml::Node*, PixelEntry> pixel_images;  // by PixelTexture node
  /// Boxes, cones, cylinders and spheres of the default measures, by type, flags and fineness: worlds have thousands,
  /// which share one mesh under different scales, and so one draw call.
  std::unordered_map<std::string, std::shared_ptr<const vrml::Mesh>> primitives;

  /// Of vectors with triangles between them, while those are there.
  struct SurfaceEntry {
    std::weak_ptr<const qnv::Cloud> cloud;
    std::array<std::shared_ptr<const vrml::Mesh>, 2> meshes;  // the second of what shows its picture
  };
  std::unordered_map<const qnv::Cloud*, SurfaceEntry> surfaces;
  [[nodiscard]] std::shared_ptr<const vrml::Mesh> surface_of(const std::shared_ptr<const qnv::Cloud>& cloud,
                                                             bool pictured);

  /// Who makes large meshes of what changes, while the former ones stay; null: each is made when it is asked for.
  std::shared_ptr<LateMeshes> late;
  PhaseClock* phases = nullptr;  // of who measures how long meshes take; null: nobody does

  /// This node has changed: a geometry, or a node that geometries are made of (Coordinate, Color, FontStyle, ...).
  void forget(const vrml::Node* node);
  /// Parts of geometries of this scene are there that were not: coordinates, colours and the like.
  void forget_scene(const vrml::SceneGraph& scene);
  /// This node of `scene` is about to be removed; its place in memory may become another's.
  void remove(const vrml::SceneGraph& scene, const vrml::Node* node);
  /// A mesh was made of this geometry.
  void made(const vrml::Node* geometry);
  /// Takes over what another one has of other scenes.
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

  std::set<std::pair<const vrml::Node*, const vrml::Node*>> geometries_of_;  // by the node that they are made of
  std::vector<const vrml::Node*> unlisted_;  // geometries that are not in it yet; most worlds never ask
};

}  // namespace gs::render
