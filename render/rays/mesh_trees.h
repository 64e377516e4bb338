#pragma once

#include "render/rays/mesh_bvh.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace gs::render {

/// Trees of large meshes, which take longer than a frame to build. They are built on separate threads, or on the thread
/// that makes the mesh. Thread-safe.
class MeshTrees {
 public:
  static constexpr std::size_t kLargeMesh = 100'000;  // triangles; smaller meshes are handled by the caller

  struct Tree {
    std::atomic<bool> ready = false;
    std::optional<MeshBvh> tree;  // valid once ready
  };
  /// Builds the tree of a mesh that will be shown soon, if a search used large meshes recently. Returns when it is
  /// complete.
  void prepare(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Returns the tree of a large mesh, which may not be ready yet. The caller keeps it alive.
  [[nodiscard]] std::shared_ptr<Tree> find(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Reports that a search uses trees of large meshes.
  void ask() { asked_ = kLately; }

 private:
  struct Prepared {
    std::weak_ptr<const vrml::Mesh> mesh;
    std::shared_ptr<Tree> tree;
  };
  static constexpr int kLately = 8;  // number of meshes

  std::atomic<int> asked_ = 0;
  std::mutex mutex_;
  std::unordered_map<const vrml::Mesh*, Prepared> prepared_;
};

}  // namespace gs::render
