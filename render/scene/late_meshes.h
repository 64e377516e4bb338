#pragma once

#include "base/noncopyable.h"
#include "render/scene/mesh_cache.h"
#include "vrml/mesh/geometry_copy.h"
#include "vrml/mesh/mesh.h"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace gs::render {

/// Job of a MeshWorker: tessellates a copy of a geometry.
struct MeshJob {
  vrml::GeometryCopy copy;
  vrml::MeshOptions options;
  std::shared_ptr<vrml::Mesh> mesh;  // valid if `done`
  std::atomic<bool> done = false;
};

/// Thread that makes meshes, in the order of submission. Skips jobs that only it owns. The destructor waits for the
/// current mesh. Thread-safe.
class MeshWorker : NonCopyable {
 public:
  /// Starts without a thread. The worker thread calls `prepare` for each new mesh and `wake` after each job.
  explicit MeshWorker(std::function<void()> wake = {},
                      std::function<void(const std::shared_ptr<const vrml::Mesh>&)> prepare = {});
  ~MeshWorker();

  void add(std::shared_ptr<MeshJob> job);
  /// Waits until all submitted jobs are done.
  void wait();

 private:
  void work();

  std::function<void()> wake_;
  std::function<void(const std::shared_ptr<const vrml::Mesh>&)> prepare_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<MeshJob>> jobs_;
  bool busy_ = false, ended_ = false;
  std::thread thread_;  // started by the first job
};

/// Decides whether a changed mesh is made within the frame or by a worker thread. The previous mesh stays visible until
/// the worker is done. Small meshes are made within the frame, in at most about three milliseconds. Runs on the world's
/// thread.
class LateMeshes {
 public:
  /// Maximum work within a frame, in elements; see vrml::tessellation_cost.
  static constexpr std::size_t kFrameWork = 200'000;
  /// Work in elements below which the copy for a worker takes too long.
  static constexpr std::size_t kSmallWork = 1'000;

  explicit LateMeshes(std::shared_ptr<MeshWorker> worker) : worker_(std::move(worker)) {}

  void begin_frame() { left_ = kFrameWork; }
  /// Reports whether this frame has time for work of `cost` elements. If so, counts it as done.
  [[nodiscard]] bool has_time_for(std::size_t cost);
  /// Submits a copy of the geometry to the worker. `level` is MeshOptions::text_level of a Text. Returns null if the
  /// budget does not permit the copy.
  [[nodiscard]] std::shared_ptr<MeshJob> hand_over(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                   const vrml::MeshOptions& options, std::size_t level);
  /// Forgets a node. Call it before the node is removed.
  void forget(const vrml::Node* node);

  struct Made {
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
  };
  /// Moves finished meshes to the cache that owns this object. Returns their geometries. Drops a mesh if a newer job
  /// has replaced it.
  [[nodiscard]] std::vector<Made> take(MeshCache& meshes);

  /// Returns the number of elements that were processed within frames so far.
  [[nodiscard]] std::uint64_t work_in_frames() const { return work_in_frames_; }
  [[nodiscard]] std::uint64_t handed_over() const { return handed_over_; }

 private:
  struct Waiting {
    Made made;
    const vrml::Node* key;
    std::size_t level;
    std::shared_ptr<MeshJob> job;
  };
  std::shared_ptr<MeshWorker> worker_;
  std::vector<Waiting> waiting_;
  std::size_t left_ = kFrameWork;
  std::uint64_t work_in_frames_ = 0, handed_over_ = 0;
};

}  // namespace gs::render
