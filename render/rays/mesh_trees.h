#pragma once

#include "render/rays/mesh_bvh.h"

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace gs::render {

/// Trees of large meshes. Building one takes longer than a frame, so other threads do it, or the thread that makes the
/// mesh. Thread-safe.
class MeshTrees {
 public:
  static constexpr std::size_t kLargeMesh = 100'000;  // minimum triangles; callers handle smaller meshes

  struct Tree {
    std::atomic<bool> ready = false;
    std::optional<MeshBvh> tree;  // valid if `ready`
  };
  /// Builds the tree of a mesh that will soon be visible, unless no search used large meshes recently. Returns when the
  /// tree is complete.
  void prepare(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Returns the tree of a large mesh, and starts to build it if it is missing. The tree may not be ready yet. The
  /// caller must hold it.
  [[nodiscard]] std::shared_ptr<Tree> find(const std::shared_ptr<const vrml::Mesh>& mesh);
  /// Records that a search uses trees of large meshes.
  void ask() { asked_ = kLately; }

 private:
  struct Prepared {
    std::weak_ptr<const vrml::Mesh> mesh;
    std::shared_ptr<Tree> tree;
  };
  static constexpr int kLately = 8;  // number of prepare() calls for which a search counts as recent

  std::atomic<int> asked_ = 0;
  std::mutex mutex_;
  std::unordered_map<const vrml::Mesh*, Prepared> prepared_;
};

}  // namespace gs::render
