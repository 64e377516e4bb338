#pragma once

#include <js/Promise.h>
#include <jsapi.h>

#include <cstddef>

namespace gs::app::script {

/// Promise jobs of one thread's programs (ECMAScript 9.4 HostEnqueuePromiseJob).
///
/// Jobs belong to the turn that enqueued them. A turn remembers size() at its start, and runs or discards all jobs from
/// there before it ends. So no job outlives its turn, its program or its world.
class JobQueue final : public JS::JobQueue {
 public:
  explicit JobQueue(JSContext* context);

  [[nodiscard]] std::size_t size() const { return jobs_.get().length(); }
  /// Runs the oldest job from place `from` on. Returns false if there is none. `*good` is false if the job ended with
  /// an exception, which is pending, or was stopped.
  bool run_one(JSContext* context, std::size_t from, bool* good);
  void discard(std::size_t from);

  // JS::JobQueue
  JSObject* getIncumbentGlobal(JSContext* context) override;
  bool enqueuePromiseJob(JSContext* context, JS::HandleObject promise, JS::HandleObject job,
                         JS::HandleObject allocation_site, JS::HandleObject incumbent_global) override;
  /// Called for debuggers only, of which there are none.
  void runJobs(JSContext*) override {}
  [[nodiscard]] bool empty() const override { return size() == 0; }

 private:
  js::UniquePtr<SavedJobQueue> saveJobQueue(JSContext* context) override;

  JS::PersistentRooted<JS::StackGCVector<JSObject*>> jobs_;
  std::size_t done_ = 0;  // jobs from `from` on that have run and stand in front of the others
};

}  // namespace gs::app::script
