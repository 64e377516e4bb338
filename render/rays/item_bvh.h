#pragma once

#include "render/rays/mesh_trees.h"
#include "render/scene/render_list.h"

#include <glm/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

namespace gs::render {

/// Hit of a line on a triangle of a RenderList. Coordinates are in world space.
struct SurfaceHit {
  std::size_t item = 0;  // index in RenderList::items
  TriangleHit triangle;  // of the item's mesh or of a patch; while a new tree is built, of the item's previous mesh
  glm::dvec3 point{0};
  /// Unit normal. Interpolated if the mesh has normals, otherwise that of the triangle with counter-clockwise corners.
  /// 0 if undefined.
  glm::dvec3 normal{0};
  /// Texture coordinate of the mesh, or of the default mapping (VRML97 6.23), before the TextureTransform.
  glm::vec2 texture_coordinate{0};
  std::optional<glm::vec3> patch_color{};  // colour, if the hit is on a patch with own colours
};

/// Triangle of a RenderList, in world space.
struct WorldTriangle {
  std::size_t item = 0;  // index in RenderList::items
  std::array<glm::dvec3, 3> corners;
};

/// Kind of items that a search considers: visible items, collidable items, or overlays.
enum class Sought : std::uint8_t { seen, met, overlay };

/// Finds the nearest triangle of a RenderList. Caches trees of meshes while these have other owners, and boxes of items
/// until they change. One thread.
class ItemBvh {
 public:
  /// Returns the nearest hit. Triangles can be hit from both sides; lines and points cannot be hit. Takes some
  /// microseconds, and time proportional to the items that changed after the last call.
  ///
  /// Other threads build the trees of large meshes. Until then, the item's previous mesh is searched. If there is none,
  /// all triangles of the mesh are tested, in about 10 ns each. If the meshes on the line have more than
  /// `max_triangles` in total, the farther meshes are ignored.
  ///
  /// Surfaces with patches are tested as drawn for a camera at the line's origin. `pixel` is the width of a pixel at
  /// distance 1. A search for collidable items uses only meshes, not patches.
  [[nodiscard]] std::optional<SurfaceHit> nearest(const RenderList& list, const SightLine& line,
                                                  std::size_t max_triangles = std::size_t{1} << 24,
                                                  Sought sought = Sought::seen,
                                                  float pixel = 1 / kUsualPixelsPerRadian);
  /// Returns at most `most` triangles of collidable items that may touch the box from `lower` to `upper`, in world
  /// space. Takes some microseconds, and time for changed items as in `nearest`.
  [[nodiscard]] std::vector<WorldTriangle> near(const RenderList& list, const glm::dvec3& lower,
                                                const glm::dvec3& upper, std::size_t most);
  /// Returns the bytes of the cached trees.
  [[nodiscard]] std::size_t bytes() const;
  /// Returns the trees of large meshes. Code on other threads can build the tree of a new mesh in them.
  [[nodiscard]] const std::shared_ptr<MeshTrees>& trees() const { return trees_; }
  /// Starts to build the trees of large meshes before a search needs them.
  void prepare(const RenderList& list);

 private:
  using Tree = MeshTrees::Tree;
  struct Kept {
    std::weak_ptr<const vrml::Mesh> mesh;
    std::size_t triangles = 0;
    std::uint64_t used = 0;  // serial number of the last search in the mesh
    std::shared_ptr<Tree> tree;
  };
  struct Item {
    std::weak_ptr<const vrml::Mesh> mesh;
    glm::dmat4 world_from_node{1.0};
    std::shared_ptr<const vrml::Mesh> searched;  // for a large mesh: last mesh of the item with a complete tree
    std::shared_ptr<Tree> tree;  // tree of `searched`
  };
  /// Mesh that a search uses for an item: its current or its previous mesh.
  struct Searched {
    const vrml::Mesh* mesh = nullptr;  // null if the meshes have too many triangles
    const MeshBvh* tree = nullptr;  // null means that all triangles are tested
  };
  Searched searched_for(std::size_t place, const DrawItem& item, std::size_t max_triangles);
  void update(const RenderList& list);
  std::shared_ptr<Tree> tree_of(const std::shared_ptr<const vrml::Mesh>& mesh, std::size_t max_triangles);

  std::shared_ptr<MeshTrees> trees_ = std::make_shared<MeshTrees>();
  std::unordered_map<const vrml::Mesh*, Kept> meshes_;
  std::size_t triangles_ = 0;  // triangles of all meshes in meshes_
  std::uint64_t searches_ = 0;
  std::vector<Item> items_;
  std::vector<Box> boxes_;
  BoxTree tree_;
  std::size_t refits_ = 0;
};

}  // namespace gs::render
