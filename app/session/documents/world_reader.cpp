#include "app/session/documents/world_reader.h"

#include "app/base/world_work.h"
#include "base/budget.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <utility>

namespace gs::app {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kWait{50};          // max wait in a step, so that progress is visible
constexpr std::chrono::milliseconds kStreamWait{1000};  // max wait while only streams load; requests end it
constexpr std::chrono::milliseconds kBetweenLists{80};
constexpr std::chrono::milliseconds kInitialBatchDelay{
    150};                 // results within this time become part of the first picture
constexpr int kRest = 3;  // pause until the next collection, as a multiple of its duration

/// Coarse version of a large volume on a server reached by ssh. Shown until the first vectors of the complete stream
/// are received. One thread.
class CoarseVersion {
 public:
  CoarseVersion(const std::string& path, const LoadOptions& options) {
    const std::string url = coarse_url_of(path, options);
    if (url.empty()) return;
    LoadOptions coarse = options;
    coarse.by_view = coarse.large_by_view = false;  // the preview has no reader that requests ranges
    coarse.component.found = nullptr;
    coarse.ledger = nullptr;
    loading_.emplace(url, coarse);
  }

  /// Handles received data. Returns a preview of the world `path`, or news without a preview if only the stream grew.
  /// Returns nullopt if nothing changed.
  std::optional<WorldReader::News> take(const std::string& path, const WorldLoading& whole) {
    if (!loading_) return std::nullopt;
    (void)loading_->step(std::chrono::milliseconds(0));
    const bool grew = loading_->streams_grew();
    render::RenderList list = loading_->changed() ? loading_->collect({0, 0, 10}) : render::RenderList{};
    if (list.splats.empty()) return grew ? std::optional(WorldReader::News{{}, {}, false, true, {}}) : std::nullopt;
    auto document = preview_document(path, *loading_, std::move(list));
    document->world.title = whole.title();
    document->world.diagnostics = whole.diagnostics();
    return WorldReader::News{std::move(document), {}, false, grew, {}};
  }
  void end() { loading_.reset(); }

 private:
  std::optional<WorldLoading> loading_;
};

}  // namespace

WorldReader::WorldReader(std::string path, LoadOptions options, std::function<void()> wake)
    : wake_(std::move(wake)), thread_([this, path = std::move(path), options = std::move(options)] {
        try {
          run(path, options);
        } catch (const std::bad_alloc&) {
          tell({make_document(world_without_memory(path)), {}, true, false, {}});
        }
        stage_ = Stage::ended;
      }) {}

WorldReader::~WorldReader() { retire(); }

void WorldReader::retire() {
  Stage running = Stage::running;
  (void)stage_.compare_exchange_strong(running, Stage::retired);
  cancel();
}

void WorldReader::request(std::vector<UrlRequest> requests) {
  const std::lock_guard lock(mutex_);
  requests_.insert(requests_.end(), std::make_move_iterator(requests.begin()), std::make_move_iterator(requests.end()));
  if (loading_) loading_->wake();
}

void WorldReader::cancel() {
  cancelled_ = true;
  const std::lock_guard lock(mutex_);
  if (loading_) loading_->wake();
}

void WorldReader::prioritize(std::unordered_map<const vrml::Node*, float> importance) {
  const std::lock_guard lock(mutex_);
  importance_ = std::move(importance);
  if (loading_) loading_->wake();
}

std::unordered_set<const vrml::Node*> WorldReader::wanted() {
  const std::lock_guard lock(mutex_);
  return wanted_;
}

WorldReader::News WorldReader::take() {
  const std::lock_guard lock(mutex_);
  News news = std::exchange(news_, {});
  news_.state = news.state;
  return news;
}

void WorldReader::tell(News news) {
  {
    const std::lock_guard lock(mutex_);
    if (news.document) news_.document = std::move(news.document);
    news_.updates.append(std::move(news.updates));
    news_.over = news_.over || news.over;
    news_.streams_grew = news_.streams_grew || news.streams_grew;
    news_.state = news.state;
  }
  if (wake_) wake_();
}

void WorldReader::run(const std::string& path, LoadOptions options) {
  options.cancelled = &cancelled_;
  options.ledger = ledger_;
  WorldLoading loading(path, options);
  CoarseVersion coarse(path, options);
  {
    const std::lock_guard lock(mutex_);
    loading_ = &loading;
  }
  bool lives = false;
  auto next = Clock::now() + kBetweenLists;
  std::optional<Clock::time_point> complete;  // time at which the nodes of the file itself were complete
  LoadingState told;
  while (!loading.done()) {
    (void)loading.step(kWait);
    if (loading.done()) break;
    if (lives) {
      take_requests(loading);
      News news{nullptr, loading.take_updates(), false, loading.streams_grew(), loading.state()};
      if (!news.updates.empty() || news.streams_grew || !(news.state == told)) {
        told = news.state;
        tell(std::move(news));
      }
      exchange_priorities(loading);
      continue;
    }
    if (loading.root_is_read()) {
      if (!complete) complete = Clock::now();
      if (Clock::now() >= *complete + kInitialBatchDelay) {
        give_away(loading);
        coarse.end();
        lives = true;
        continue;
      }
    } else {
      complete.reset();
    }
    if (Clock::now() < next) continue;
    const auto start = Clock::now();
    const LoadingState state = loading.state();
    if (loading.changed()) {
      render::RenderList list = loading.collect({0, 0, 10});
      const bool shows = !list.items.empty() || !list.splats.empty();
      if (shows) coarse.end();
      tell({shows ? preview_document(path, loading, std::move(list)) : nullptr, {}, false, false, state});
    } else if (auto preview = coarse.take(path, loading)) {
      preview->state = state;
      tell(std::move(*preview));
    } else if (!(state == told)) {
      tell({nullptr, {}, false, false, state});
    }
    told = state;
    next = Clock::now() + std::max<Clock::duration>(kBetweenLists, kRest * (Clock::now() - start));
  }
  if (stage_ == Stage::running) {
    if (!lives) give_away(loading);
    tell({nullptr, loading.take_updates(), true, false, loading.state()});
  }
  while (stage_ == Stage::running) {
    take_requests(loading);
    if (loading.done() && !loading.streaming()) {
      loading.rest(kStreamWait);
      continue;
    }
    (void)loading.step(loading.done() ? kStreamWait : kWait);
    const bool grew = loading.streams_grew();
    if (ResourceUpdates updates = loading.take_updates(); grew || !updates.empty())
      tell({nullptr, std::move(updates), false, grew, loading.state()});
  }
  const std::lock_guard lock(mutex_);
  loading_ = nullptr;
}

// Makes the document and hands it to the owner's thread. Starts time in its world unless it has Scripts.
void WorldReader::give_away(WorldLoading& loading) {
  render::MeshCache meshes;
  LoadedWorld world = loading.take(&meshes);
  const WorldBudget budget = world.scene ? world.scene->budget() : own_budget();
  budget->stop_when([this] { return cancelled_.load(); });
  auto document = make_document(std::move(world), std::move(meshes));
  budget->stop_when(is_work_unwanted);
  tell({std::move(document), {}, false, false, loading.state()});
}

void WorldReader::take_requests(WorldLoading& loading) {
  std::vector<UrlRequest> requests;
  {
    const std::lock_guard lock(mutex_);
    requests.swap(requests_);
  }
  if (!requests.empty()) loading.request(std::move(requests));
}

void WorldReader::exchange_priorities(WorldLoading& loading) {
  const std::lock_guard lock(mutex_);
  wanted_ = loading.wanted();
  if (auto importance = std::exchange(importance_, std::nullopt)) loading.prioritize(std::move(*importance));
}

}  // namespace gs::app
