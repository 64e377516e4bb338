#pragma once

#include <js/Promise.h>
#include <jsapi.h>

#include <cstddef>

namespace gs::app::script {

/// Queue of promise jobs of all programs on one thread (ECMAScript 9.4 HostEnqueuePromiseJob).
///
/// A turn, which is one call of a program, stores size() at its start. Before its end, it runs or discards all later
/// jobs. Thus no job outlives its turn, its program or its world.
class JobQueue final : public JS::JobQueue {
 public:
  explicit JobQueue(JSContext* context);

  [[nodiscard]] std::size_t size() const { return jobs_.get().length(); }
  /// Runs the oldest waiting job at index `from` or later. Returns false if there is none. Sets `*good` to false if the
  /// job was stopped or threw; then the exception is pending.
  bool run_one(JSContext* context, std::size_t from, bool* good);
  void discard(std::size_t from);

  // Overrides of JS::JobQueue.
  JSObject* getIncumbentGlobal(JSContext* context) override;
  bool enqueuePromiseJob(JSContext* context, JS::HandleObject promise, JS::HandleObject job,
                         JS::HandleObject allocation_site, JS::HandleObject incumbent_global) override;
  /// Does nothing, because turns run their jobs with run_one().
  void runJobs(JSContext*) override {}
  [[nodiscard]] bool empty() const override { return size() == 0; }

 private:
  js::UniquePtr<SavedJobQueue> saveJobQueue(JSContext* context) override;

  JS::PersistentRooted<JS::StackGCVector<JSObject*>> jobs_;
  std::size_t done_ = 0;  // number of finished jobs that are stored before the waiting ones
};

}  // namespace gs::app::script
