#pragma once

#include "render/rays/mesh_bvh.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace gs::render {

/// Trees of large meshes, which take longer than a frame. They are made on threads of their own, or by the thread that
/// makes the mesh. Any thread.
class MeshTrees {
 public:
  static constexpr std::size_t kLargeMesh = 100'000;  // triangles: of smaller ones nobody is told

  struct Tree {
    std::atomic<bool> ready = false;
    std::optional<MeshBvh> tree;  // once it is ready
  };
  /// Makes the tree of a mesh that others are to see soon, if anybody has asked for trees of large meshes lately; it is
  /// there when this returns.
  void prepare(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// The tree of a large mesh, which may not be ready yet. It is for the caller to keep.
  [[nodiscard]] std::shared_ptr<Tree> find(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Somebody looks into trees of large meshes.
  void ask() { asked_ = kLately; }

 private:
  struct Prepared {
    std::weak_ptr<const vrml::Mesh> mesh;
    std::shared_ptr<Tree> tree;
  };
  static constexpr int kLately = 8;  // meshes

  std::atomic<int> asked_ = 0;
  std::mutex mutex_;
  std::unordered_map<const vrml::Mesh*, Prepared> prepared_;
};

}  // namespace gs::render
