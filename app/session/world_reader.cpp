#include "app/session/world_reader.h"

#include "app/base/world_budget.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kWait{50};          // so that progress shows
constexpr std::chrono::milliseconds kStreamWait{1000};  // wishes of views end it
constexpr std::chrono::milliseconds kBetweenLists{80};
constexpr int kRest = 3;  // times as long as gathering took, before the next time

}  // namespace

WorldReader::WorldReader(std::string path, LoadOptions options, std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this, path = std::move(path), options = std::move(options)] {
        try {
          run(path, options);
        } catch (const std::bad_alloc&) {
          tell({make_document(world_without_memory(path)), true, false, {}});
        }
        ended_ = true;
      }) {}

WorldReader::~WorldReader() {
  stop_ = true;
  cancel();
}

void WorldReader::cancel() {
  cancelled_ = true;
  const std::lock_guard lock(mutex_);
  if (loading_) loading_->wake();
}

WorldReader::News WorldReader::take() {
  const std::lock_guard lock(mutex_);
  News news = news_;
  news_.document.reset();
  news_.over = news_.fed = false;
  return news;
}

void WorldReader::tell(News news) {
  {
    const std::lock_guard lock(mutex_);
    if (news.document) {
      news_.document = std::move(news.document);
      news_.over = news.over;
    }
    news_.fed = news_.fed || news.fed;
    news_.state = news.state;
  }
  if (wake_) wake_();
}

void WorldReader::run(const std::string& path, LoadOptions options) {
  options.cancelled = &cancelled_;
  WorldLoading loading(path, options);
  {
    const std::lock_guard lock(mutex_);
    loading_ = &loading;
  }
  auto next = Clock::now() + kBetweenLists;
  LoadingState told;
  while (!loading.done()) {
    (void)loading.step(kWait);
    if (loading.done() || Clock::now() < next) continue;
    const auto start = Clock::now();
    const LoadingState state = loading.state();
    if (loading.changed()) {
      render::RenderList list = loading.collect({0, 0, 10});
      const bool shows = !list.items.empty() || !list.splats.empty();
      tell({shows ? preview_document(path, loading, std::move(list)) : nullptr, false, false, state});
    } else if (!(state == told)) {
      tell({nullptr, false, false, state});
    }
    told = state;
    next = Clock::now() + std::max<Clock::duration>(kBetweenLists, kRest * (Clock::now() - start));
  }
  if (!stop_) {
    render::MeshCache meshes;
    OpenedWorld world = loading.take(&meshes);
    const WorldBudget budget = world.scene ? world.scene->budget() : own_budget();
    budget->stop_when([this] { return cancelled_.load(); });
    auto document = make_document(std::move(world), std::move(meshes));
    budget->stop_when({});
    tell({std::move(document), true, false, loading.state()});
  }
  while (!stop_ && loading.streaming()) {
    (void)loading.step(kStreamWait);
    if (loading.fed()) tell({nullptr, false, true, loading.state()});
  }
  const std::lock_guard lock(mutex_);
  loading_ = nullptr;
}

}  // namespace gs::app
