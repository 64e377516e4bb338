#include "app/script/engine/job_queue.h"

#include <js/CallAndConstruct.h>
#include <js/Realm.h>
#include <js/ValueArray.h>
#include <jsfriendapi.h>

#include <algorithm>
#include <utility>

namespace gs::app::script {

JobQueue::JobQueue(JSContext* context) : jobs_(context, JS::StackGCVector<JSObject*>(context)) {}

JSObject* JobQueue::getIncumbentGlobal(JSContext* context) { return JS::CurrentGlobalOrNull(context); }

bool JobQueue::enqueuePromiseJob(JSContext* context, JS::HandleObject, JS::HandleObject job, JS::HandleObject,
                                 JS::HandleObject) {
  if (jobs_.get().append(job)) return true;
  JS_ReportOutOfMemory(context);
  return false;
}

js::UniquePtr<JS::JobQueue::SavedJobQueue> JobQueue::saveJobQueue(JSContext* context) {
  JS_ReportOutOfMemory(context);
  return nullptr;
}

bool JobQueue::run_one(JSContext* context, std::size_t from, bool* good) {
  constexpr std::size_t kMaxDone = 1024;
  auto& jobs = jobs_.get();
  if (from + done_ >= jobs.length()) {
    discard(from);
    return false;
  }
  JS::RootedObject job(context, std::exchange(jobs[from + done_], nullptr));
  if (++done_ >= kMaxDone) {
    jobs.erase(jobs.begin() + from, jobs.begin() + from + done_);
    done_ = 0;
  }
  // Save the count, because the job may start a nested turn, which counts its own jobs from 0.
  const std::size_t done = std::exchange(done_, 0);
  const JSAutoRealm realm(context, job);
  JS::RootedValue ignored(context);
  *good = JS::Call(context, JS::UndefinedHandleValue, job, JS::HandleValueArray::empty(), &ignored);
  done_ = done;
  return true;
}

void JobQueue::discard(std::size_t from) {
  done_ = 0;
  if (from < size()) jobs_.get().shrinkTo(from);
}

}  // namespace gs::app::script
