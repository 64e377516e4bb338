#pragma once

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

/// A mesh that is made of a copy of its nodes.
struct MeshJob {
  vrml::GeometryCopy copy;
  vrml::MeshOptions options;
  std::shared_ptr<vrml::Mesh> mesh;  // once it is done
  std::atomic<bool> done = false;
};

/// A thread that makes meshes, one after the other in the order in which they were handed over. Those that nobody waits
/// for any more are left out. It ends with this, behind the mesh that it is at. Any thread.
class MeshWorker {
 public:
  /// `prepare`: what else is made of a new mesh there. `wake`: called there whenever one is done.
  explicit MeshWorker(std::function<void()> wake = {},
                      std::function<void(const std::shared_ptr<const vrml::Mesh>&)> prepare = {});
  ~MeshWorker();
  MeshWorker(const MeshWorker&) = delete;
  MeshWorker& operator=(const MeshWorker&) = delete;

  void add(std::shared_ptr<MeshJob> job);
  /// Returns when nothing is left to do.
  void wait();

 private:
  void work();

  std::function<void()> wake_;
  std::function<void(const std::shared_ptr<const vrml::Mesh>&)> prepare_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::shared_ptr<MeshJob>> jobs_;
  bool busy_ = false, ended_ = false;
  std::thread thread_;  // begins with the first job
};

/// Which meshes of a world that lives are made within the frame, and which by a worker while the former ones are shown:
/// small ones are, and as many as take about three milliseconds. One thread, that of the world.
class LateMeshes {
 public:
  /// In elements; see vrml::tessellation_cost.
  static constexpr std::size_t kFrameWork = 200'000;
  /// What costs less is not worth a copy.
  static constexpr std::size_t kSmallWork = 1'000;

  explicit LateMeshes(std::shared_ptr<MeshWorker> worker) : worker_(std::move(worker)) {}

  void begin_frame() { left_ = kFrameWork; }
  /// Whether there is time in this frame for so much work, which is then counted as done.
  [[nodiscard]] bool has_time_for(std::size_t cost);
  /// Hands over what makes the mesh of the node as it is now; `level`: of a Text, MeshOptions::text_level. Null: there
  /// is no room for the copy.
  [[nodiscard]] std::shared_ptr<MeshJob> hand_over(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                                   const vrml::MeshOptions& options, std::size_t level);
  /// This node is about to be removed.
  void forget(const vrml::Node* node);

  struct Made {
    const vrml::SceneGraph* scene = nullptr;
    vrml::NodeId node;
  };
  /// Takes the meshes that are done into the cache, whose `late` this is, and tells whose they are. Those that were
  /// made in another way meanwhile are dropped.
  [[nodiscard]] std::vector<Made> take(MeshCache& meshes);

  /// Elements that were gone through in frames, and how many meshes were handed over, so far.
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
