#include "render/scene/late_meshes.h"

#include <algorithm>
#include <new>
#include <utility>

namespace gs::render {

// ---- Functions of the worker thread

MeshWorker::MeshWorker(std::function<void()> wake,
                       std::function<void(const std::shared_ptr<const vrml::Mesh>&)> prepare)
    : wake_(std::move(wake)), prepare_(std::move(prepare)) {}

MeshWorker::~MeshWorker() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    jobs_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void MeshWorker::add(std::shared_ptr<MeshJob> job) {
  {
    const std::lock_guard lock(mutex_);
    jobs_.push_back(std::move(job));
    if (!thread_.joinable()) thread_ = std::thread([this] { work(); });
  }
  changed_.notify_all();
}

void MeshWorker::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return jobs_.empty() && !busy_; });
}

void MeshWorker::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ended_ || !jobs_.empty(); });
    if (ended_) return;
    std::shared_ptr<MeshJob> job = std::move(jobs_.front());
    jobs_.pop_front();
    busy_ = true;
    lock.unlock();
    if (job.use_count() > 1) {
      auto mesh = std::make_shared<vrml::Mesh>();
      try {
        *mesh = vrml::tessellate(*job->copy.scene, job->copy.geometry, job->options);
        if (prepare_) prepare_(mesh);
      } catch (const std::bad_alloc&) {
        *mesh = {};
        mesh->limited = true;
      }
      job->copy = {};  // without this copy, the mesh is the only owner of its arrays
      job->mesh = std::move(mesh);
      job->done = true;
      if (wake_) wake_();
    }
    job = nullptr;
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

// ---- Functions of the world's thread

bool LateMeshes::has_time_for(std::size_t cost) {
  if (cost > kSmallWork && cost > left_) return false;
  left_ -= std::min(left_, cost);
  work_in_frames_ += cost;
  return true;
}

std::shared_ptr<MeshJob> LateMeshes::hand_over(const vrml::SceneGraph& scene, vrml::NodeId geometry,
                                               const vrml::MeshOptions& options, std::size_t level) {
  auto job = std::make_shared<MeshJob>();
  job->copy = vrml::copy_geometry(scene, geometry, options.refiner);
  if (!job->copy.scene) return nullptr;
  job->options = options;
  job->options.refiner = job->copy.refiner;
  waiting_.push_back({{&scene, geometry}, &scene.node(geometry), level, job});
  ++handed_over_;
  worker_->add(job);
  return job;
}

void LateMeshes::forget(const vrml::Node* node) {
  std::erase_if(waiting_, [&](const Waiting& one) { return one.key == node; });
}

std::vector<LateMeshes::Made> LateMeshes::take(MeshCache& meshes) {
  std::vector<Made> made;
  std::erase_if(waiting_, [&](const Waiting& one) {
    if (!one.job->done) return false;
    const auto known = meshes.meshes.find(one.key);
    if (known == meshes.meshes.end()) return true;
    MeshCache::Entry* entry = &known->second;
    if (one.level < vrml::kTextBars) entry = entry->finer ? &entry->finer->levels[one.level] : nullptr;
    if (!entry || entry->job != one.job) return true;
    MeshCache::keep(*entry, std::move(one.job->mesh), one.made.scene->budget());
    entry->texture_coordinates = one.job->options.texture_coordinates;
    entry->job = nullptr;
    made.push_back(one.made);
    return true;
  });
  return made;
}

}  // namespace gs::render
