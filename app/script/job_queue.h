#pragma once

#include <js/Promise.h>
#include <jsapi.h>

#include <cstddef>

namespace gs::app::script {

/// Promise jobs of one thread's programs (ECMAScript 9.4 HostEnqueuePromiseJob).
///
/// A turn is one call of a program. It stores size() at its start. Before it ends, it runs or discards all later jobs.
/// So no job outlives its turn, its program or its world.
class JobQueue final : public JS::JobQueue {
 public:
  explicit JobQueue(JSContext* context);

  [[nodiscard]] std::size_t size() const { return jobs_.get().length(); }
  /// Runs the oldest job from place `from` on. Returns false if there is none. Sets `*good` to false if the job
  /// was stopped or threw; the exception is then pending.
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
  std::size_t done_ = 0;  // finished jobs that are still stored before the waiting ones
};

}  // namespace gs::app::script
