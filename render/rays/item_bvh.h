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

/// Where a line meets a triangle of a RenderList, in world space.
struct SurfaceHit {
  std::size_t item = 0;  // of RenderList::items
  TriangleHit triangle;  // of its mesh; of a former one of the item, where the tree of that is still made; of a patch
  glm::dvec3 point{0};
  /// Of length 1: of the mesh's normals if it has some, else of the triangle, towards where its corners go
  /// counter-clockwise. 0 where there is none.
  glm::dvec3 normal{0};
  /// Of the mesh, or as 6.23 makes them of its box; without the TextureTransform.
  glm::vec2 texture_coordinate{0};
  std::optional<glm::vec3> patch_color{};  // of a patch that has colours of its own
};

/// A triangle of a RenderList, in world space.
struct WorldTriangle {
  std::size_t item = 0;  // of RenderList::items
  std::array<glm::dvec3, 3> corners;
};

/// Which items of a RenderList are asked for: those that are seen, those that the viewer may bump into, or those that
/// are seen over all others.
enum class Sought : std::uint8_t { seen, met, overlay };

/// Finds the nearest triangle of a RenderList. Keeps what it learned of meshes as long as somebody else holds them, and
/// the boxes of the items until they change. One thread.
class ItemBvh {
 public:
  /// Triangles count from both sides; lines and points are too thin to meet. Takes time for each item that has changed
  /// since the last call, and some microseconds. Until the tree of a large mesh is made meanwhile, the item's former
  /// one counts; of the first one all triangles are looked at, in some 10 ns each.
  /// Of meshes whose triangles are more than `max_triangles` together the farther ones are not met.
  /// Surfaces with patches are met as they are drawn from where the line begins, with pixels that are so wide at
  /// distance 1; but what is sought to be bumped into has no patches, only the items' meshes.
  [[nodiscard]] std::optional<SurfaceHit> nearest(const RenderList& list, const SightLine& line,
                                                  std::size_t max_triangles = std::size_t{1} << 24,
                                                  Sought sought = Sought::seen,
                                                  float pixel = 1 / kUsualPixelsPerRadian);
  /// Triangles of what is met that may touch the box from `lower` to `upper`, world space; no more than `most`. Takes
  /// some microseconds, and time for what has changed as `nearest` does.
  [[nodiscard]] std::vector<WorldTriangle> near(const RenderList& list, const glm::dvec3& lower,
                                                const glm::dvec3& upper, std::size_t most);
  /// What it keeps of meshes.
  [[nodiscard]] std::size_t bytes() const;
  /// The trees of large meshes, for who makes such meshes on another thread.
  [[nodiscard]] const std::shared_ptr<MeshTrees>& trees() const { return trees_; }
  /// Has the trees of large meshes made, so that they are there when somebody asks.
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
    std::shared_ptr<const vrml::Mesh> searched;  // a large one, the last whose tree was ready
    std::shared_ptr<Tree> tree;                  // of that
  };
  /// What is searched for an item now: its mesh, or a former one.
  struct Searched {
    const vrml::Mesh* mesh = nullptr;  // null: there are too many triangles
    const MeshBvh* tree = nullptr;     // null: all triangles
  };
  Searched searched_for(std::size_t place, const DrawItem& item, std::size_t max_triangles);
  void update(const RenderList& list);
  std::shared_ptr<Tree> tree_of(const std::shared_ptr<const vrml::Mesh>& mesh, std::size_t max_triangles);

  std::shared_ptr<MeshTrees> trees_ = std::make_shared<MeshTrees>();
  std::unordered_map<const vrml::Mesh*, Kept> meshes_;
  std::size_t triangles_ = 0;  // of meshes_
  std::uint64_t searches_ = 0;
  std::vector<Item> items_;
  std::vector<vrml::Bounds> boxes_;
  BoxTree tree_;
  std::size_t refits_ = 0;
};

}  // namespace gs::render
