#include "app/script/engine/engine.h"

#include "app/script/bounds/bounded_natives.h"
#include "app/script/engine/job_queue.h"
#include "base/thread_time.h"

#include <js/ContextOptions.h>
#include <js/GCAPI.h>
#include <js/Initialization.h>
#include <js/Interrupt.h>
#include <js/MemoryMetrics.h>
#include <js/Stack.h>
#include <jsfriendapi.h>
#include <malloc.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace gs::app::script {
namespace {

// bytes of the whole heap, including garbage; the limits of single worlds are lower
constexpr std::uint32_t kHeapOfEngine = 1024U << 20;
// bytes; exceeded by endless recursion before the thread's stack is full
constexpr std::size_t kStack = std::size_t{512} << 10;
constexpr std::chrono::milliseconds kLook{10};
constexpr int kLooksAtNothing = 100;  // number of looks without a turn before the watcher sleeps
constexpr std::chrono::seconds kOverdue{2};
// additional time for a program that had to wait for a processor; less than kOverdue
constexpr std::chrono::seconds kWait{1};

/// Function that Engine::on_overdue() sets.
struct OverdueObserver {
  std::mutex mutex;
  std::function<void(const std::string&)> call;
};
OverdueObserver& overdue_observer() {
  static OverdueObserver the_observer;
  return the_observer;
}

// The SpiderMonkey library. Initialised with the first engine; shut down at the end of this program if no engine is
// left.
struct Library {
  Library() {
    (void)BlockLimit::install();
    good = JS_Init();
  }
  ~Library() {
    if (good && engines == 0) JS_ShutDown();
  }
  bool good = false;
  std::atomic<int> engines = 0;
};
Library& library() {
  static Library the_library;
  return the_library;
}

std::size_t bytes_at(const void* block) { return malloc_usable_size(const_cast<void*>(block)); }

class NoPrivates final : public JS::ObjectPrivateVisitor {
 public:
  NoPrivates() : ObjectPrivateVisitor([](JSObject*, nsISupports**) { return false; }) {}
  std::size_t sizeOfIncludingThis(nsISupports*) override { return 0; }
};

}  // namespace

Engine* Engine::of_this_thread() {
  if (!library().good) return nullptr;
  static thread_local std::unique_ptr<Engine> engine;
  if (engine) return engine.get();
  JSContext* const context = JS_NewContext(kHeapOfEngine);
  if (!context) return nullptr;
  if (!JS::InitSelfHostedCode(context)) {
    JS_DestroyContext(context);
    return nullptr;
  }
  engine.reset(new Engine(context));
  return engine.get();
}

Engine::Engine(JSContext* context) : context_(context), jobs_(std::make_unique<JobQueue>(context)) {
  ++library().engines;
  JS::SetJobQueue(context_, jobs_.get());
  JS_SetContextPrivate(context_, this);
  JS_SetNativeStackQuota(context_, kStack);
  // Use only the simplest compilers, because programs are untrusted. Collect garbage without increments, so that nodes
  // are released at once.
  JS::ContextOptionsRef(context_).setWasm(false).setAsmJS(false);
  JS_SetGlobalJitCompilerOption(context_, JSJITCOMPILER_ION_ENABLE, 0);
  JS_SetGCParameter(context_, JSGC_INCREMENTAL_GC_ENABLED, 0);
  JS_SetGCParameter(context_, JSGC_COMPACTING_ENABLED, 0);
  JS_AddInterruptCallback(context_, on_interrupt);
  bound_evaluation(context_);
}

Engine::~Engine() {
  if (watcher_.joinable()) {
    {
      const std::lock_guard lock(mutex_);
      ends_ = true;
    }
    wake_.notify_all();
    watcher_.join();
  }
  // Destroy the queue before the context, because it roots objects of the context.
  JS::SetJobQueue(context_, nullptr);
  jobs_.reset();
  JS_DestroyContext(context_);
  --library().engines;
}

Engine::Turn::Turn(Engine& engine, double seconds, std::size_t heap_bytes, const std::string& late_message)
    : engine_(engine), outermost_(engine.depth_++ == 0), first_job_(engine.jobs_->size()) {
  if (!outermost_) return;
  engine_.stop_ = Stop::none;
  engine_.heap_limit_ = heap_bytes;
  engine_.collect_leftovers();
  engine_.deadline_ =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  engine_.processor_deadline_ = thread_seconds() + seconds;
  engine_.late_message_ = &late_message;
  engine_.turns_.fetch_add(1, std::memory_order_relaxed);
  engine_.busy_.store(true, std::memory_order_release);
  if (!engine_.asleep_.load(std::memory_order_acquire)) return;
  const std::lock_guard lock(engine_.mutex_);
  if (!engine_.watcher_.joinable()) engine_.watcher_ = std::thread([&self = engine_] { self.watch(); });
  engine_.asleep_ = false;
  engine_.wake_.notify_all();
}

bool Engine::Turn::run_job(bool* good) { return engine_.jobs_->run_one(engine_.context_, first_job_, good); }

Engine::Turn::~Turn() {
  engine_.jobs_->discard(first_job_);
  if (--engine_.depth_ != 0) return;
  engine_.busy_.store(false, std::memory_order_release);
  if (Clock::now() - engine_.deadline_.load() <= kOverdue) return;
  // Wait until the watcher no longer uses the message.
  const std::lock_guard lock(overdue_observer().mutex);
  engine_.late_message_ = nullptr;
}

// Runs on the watcher thread. Interrupts a running turn regularly, so that on_interrupt() checks its limits. Sleeps
// while no turn runs.
void Engine::watch() {
  std::unique_lock lock(mutex_);
  int nothing = 0;
  std::uint32_t seen = 0;
  while (!ends_) {
    if (asleep_) {
      wake_.wait(lock, [&] { return ends_ || !asleep_; });
      nothing = 0;
      continue;
    }
    wake_.wait_for(lock, kLook, [&] { return ends_; });
    if (busy_.load(std::memory_order_acquire)) {
      JS_RequestInterruptCallback(context_);
      if (Clock::now() - deadline_.load() > kOverdue) tell_overdue();
    }
    const std::uint32_t turns = turns_.load(std::memory_order_relaxed);
    nothing = turns == seen && !busy_ ? nothing + 1 : 0;
    seen = turns;
    if (nothing > kLooksAtNothing) asleep_ = true;
  }
}

void Engine::tell_overdue() const {
  OverdueObserver& observer = overdue_observer();
  const std::lock_guard lock(observer.mutex);
  const std::string* const message = late_message_.load();
  if (observer.call && message && busy_.load(std::memory_order_acquire)) observer.call(*message);
}

void Engine::on_overdue(std::function<void(const std::string&)> observer) {
  OverdueObserver& known = overdue_observer();
  const std::lock_guard lock(known.mutex);
  known.call = std::move(observer);
}

bool Engine::on_interrupt(JSContext* context) {
  auto* const engine = static_cast<Engine*>(JS_GetContextPrivate(context));
  if (engine->depth_ == 0) return true;
  if (engine->over_time()) {
    engine->stop_ = Stop::time;
    return false;
  }
  if (!engine->over_memory()) return true;
  // Collect first, because garbage of other programs does not count.
  JS_GC(context);
  if (!engine->over_memory()) return true;
  engine->stop_ = Stop::memory;
  engine->nodes_made_ = engine->next_collection_;  // makes rest() collect the garbage of the program
  return false;
}

// Reports whether the turn exceeds its time. On a busy machine, a turn waits for a processor. Up to kWait, this time
// does not count.
bool Engine::over_time() const {
  const Clock::duration late = Clock::now() - deadline_.load();
  return late >= kWait || (late >= Clock::duration::zero() && thread_seconds() >= processor_deadline_);
}

// Reports whether programs exceed the memory limit. SpiderMonkey's own count includes only objects, not their blocks
// such as the elements of arrays. Therefore everything is measured after each collection; SpiderMonkey begins a
// collection when blocks have grown.
bool Engine::over_memory() {
  const std::uint32_t number = JS_GetGCParameter(context_, JSGC_MAJOR_GC_NUMBER);
  if (number != measured_at_) {
    measured_at_ = number;
    JS::RootedObject global(context_, JS::CurrentGlobalOrNull(context_));
    NoPrivates visitor;
    JS::TabSizes sizes;
    measured_ = 0;
    if (global && JS::AddSizeOfTab(context_, global, bytes_at, &visitor, &sizes))
      measured_ = sizes.objects_ + sizes.strings_ + sizes.private_ + sizes.other_;
  }
  const std::size_t own = own_bytes_ > 0 ? static_cast<std::size_t>(own_bytes_) : 0;
  return std::max<std::size_t>(measured_, JS_GetGCParameter(context_, JSGC_BYTES)) + own > heap_limit_;
}

bool Engine::may_have(std::size_t bytes) const {
  const std::size_t own = own_bytes_ > 0 ? static_cast<std::size_t>(own_bytes_) : 0;
  return bytes <= heap_limit_ && own <= heap_limit_ - bytes;
}

// Collects values of earlier programs, so that they do not count against this one. Collects again only after growth by
// a quarter, because the values may still be in use.
void Engine::collect_leftovers() {
  const bool is_little = own_bytes_ <= static_cast<std::ptrdiff_t>(heap_limit_ / 2);
  if (is_little) next_own_collection_ = 0;
  if (is_little || own_bytes_ <= next_own_collection_) return;
  JS_GC(context_);
  next_own_collection_ = own_bytes_ + own_bytes_ / 4;
}

void Engine::note_nodes(std::size_t count) { nodes_made_ += count; }

void Engine::rest() {
  if (depth_ != 0 || nodes_made_ < next_collection_) return;
  nodes_made_ = 0;
  JS_GC(context_);
}

}  // namespace gs::app::script
