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

/// Hit of a line on a triangle of a RenderList, in world space.
struct SurfaceHit {
  std::size_t item = 0;  // index in RenderList::items
  TriangleHit triangle;  // of the item's mesh, of its previous mesh while the new tree is being built, or of a patch
  glm::dvec3 point{0};
  /// Unit normal: interpolated from the mesh if it has normals, else that of the triangle by counter-clockwise corners.
  /// 0 if undefined.
  glm::dvec3 normal{0};
  /// From the mesh, or by the default mapping of 6.23; without the TextureTransform.
  glm::vec2 texture_coordinate{0};
  std::optional<glm::vec3> patch_color{};  // of a patch with own colours
};

/// Triangle of a RenderList, in world space.
struct WorldTriangle {
  std::size_t item = 0;  // index in RenderList::items
  std::array<glm::dvec3, 3> corners;
};

/// Items that a search considers: visible ones, collidable ones, or overlays.
enum class Sought : std::uint8_t { seen, met, overlay };

/// Finds the nearest triangle of a RenderList. Caches data of meshes while other owners hold them, and item boxes until
/// they change. Single-threaded.
class ItemBvh {
 public:
  /// Returns the nearest hit. Triangles count from both sides; lines and points are never hit. Takes time proportional
  /// to the items changed since the last call, plus some microseconds. While the tree of a large mesh is built on
  /// another thread, the item's previous mesh counts; for its first mesh, all triangles are tested in about 10 ns each.
  /// If the hit meshes have more than `max_triangles` in total, the farther ones are ignored. Surfaces with patches are
  /// tested as drawn from the line's origin, with pixels of width `pixel` at distance 1. Searches for collidable items
  /// use only the items' meshes, not patches.
  [[nodiscard]] std::optional<SurfaceHit> nearest(const RenderList& list, const SightLine& line,
                                                  std::size_t max_triangles = std::size_t{1} << 24,
                                                  Sought sought = Sought::seen,
                                                  float pixel = 1 / kUsualPixelsPerRadian);
  /// Returns collidable triangles that may touch the box `lower` to `upper` in world space, at most `most`. Takes some
  /// microseconds, plus time for changed items like `nearest`.
  [[nodiscard]] std::vector<WorldTriangle> near(const RenderList& list, const glm::dvec3& lower,
                                                const glm::dvec3& upper, std::size_t most);
  /// Returns the bytes cached for meshes.
  [[nodiscard]] std::size_t bytes() const;
  /// Returns the trees of large meshes, for code that makes such meshes on another thread.
  [[nodiscard]] const std::shared_ptr<MeshTrees>& trees() const { return trees_; }
  /// Starts building the trees of large meshes before they are needed.
  void prepare(const RenderList& list);

 private:
  using Tree = MeshTrees::Tree;
  struct Kept {
    std::weak_ptr<const vrml::Mesh> mesh;
    std::size_t triangles = 0;
    std::uint64_t used = 0;  // number of the last search
    std::shared_ptr<Tree> tree;
  };
  struct Item {
    std::weak_ptr<const vrml::Mesh> mesh;
    glm::dmat4 world_from_node{1.0};
    std::shared_ptr<const vrml::Mesh> searched;  // large mesh: the last one with a complete tree
    std::shared_ptr<Tree> tree;                  // tree of that mesh
  };
  /// Mesh to search for an item: its present or a previous one.
  struct Searched {
    const vrml::Mesh* mesh = nullptr;  // null if there are too many triangles
    const MeshBvh* tree = nullptr;     // null means testing all triangles
  };
  Searched searched_for(std::size_t place, const DrawItem& item, std::size_t max_triangles);
  void update(const RenderList& list);
  std::shared_ptr<Tree> tree_of(const std::shared_ptr<const vrml::Mesh>& mesh, std::size_t max_triangles);

  std::shared_ptr<MeshTrees> trees_ = std::make_shared<MeshTrees>();
  std::unordered_map<const vrml::Mesh*, Kept> meshes_;
  std::size_t triangles_ = 0;  // total of meshes_
  std::uint64_t searches_ = 0;
  std::vector<Item> items_;
  std::vector<Box> boxes_;
  BoxTree tree_;
  std::size_t refits_ = 0;
};

}  // namespace gs::render
