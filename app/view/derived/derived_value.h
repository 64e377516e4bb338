#pragma once

#include "app/view/derived/volume_derivations.h"
#include "base/noncopyable.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gs::app {

/// Content that another thread computes from the values of a volume, for the wish of a viewport. While a stream is
/// received, its values improve, and the content is computed again, in at most half of the time. The previous content
/// stays until the new content is ready. Keeps the content of a few wishes, for several viewports. One thread. The
/// destructor cancels a running computation and waits for its end.
template <class Wish, class Content>
class DerivedValue : NonCopyable {
 public:
  using Grid = std::shared_ptr<const VolumeGrid>;
  /// Function that computes the content on another thread.
  using Make = std::function<DerivedContent<Content>(const Grid& grid, const Wish& wish, Progress& progress)>;

  DerivedValue() = default;
  ~DerivedValue() {
    if (progress_) progress_->cancelled = true;
  }

  /// Returns the newest content for this wish. If there is none yet, returns the last content for any wish, so that the
  /// picture follows a slider. Returns null if there is no content. Starts `make` if the values are newer.
  std::shared_ptr<const Content> get(const Grid& grid, const Wish& wish, Make make) {
    const auto now = Clock::now();
    auto found = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& one) { return one.wish == wish; });
    if (found != entries_.end()) {
      std::rotate(found, found + 1, entries_.end());
      found = std::prev(entries_.end());
    }
    const auto content = found == entries_.end() ? nullptr : found->content;
    const bool is_newest = found != entries_.end() && found->grid.lock() == grid;
    problem_ = found == entries_.end() ? std::string() : found->problem;
    if (coming_.valid()) {
      if (coming_wish_ == wish) wished_ = now;
      // Cancel a long computation after the user has changed the wish.
      else if (now - begun_ > kPatience && now - wished_ > kPatience)
        progress_->cancelled = true;
    } else if (!is_newest && content && now - ended_ < took_) {
      rests_ = true;
    } else if (!is_newest) {
      begin(grid, wish, std::move(make), now);
    }
    return content || is_newest ? content : last_.lock();
  }

  /// Takes content that is ready. Returns true if there is any, or if a rest between two computations has ended.
  bool take() {
    if (rests_ && Clock::now() - ended_ >= took_) return !(rests_ = false);
    if (!coming_.valid() || coming_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    auto made = coming_.get();
    ended_ = Clock::now();
    took_ = ended_ - begun_;
    if (progress_->cancelled) return true;
    std::erase_if(entries_, [this](const Entry& one) { return one.wish == coming_wish_; });
    if (entries_.size() >= kMostEntries) entries_.erase(entries_.begin());
    Entry entry{std::move(coming_wish_), coming_grid_, nullptr, {}};
    if (auto* problem = std::get_if<std::string>(&made))
      entry.problem = std::move(*problem);
    else
      last_ = entry.content = std::move(std::get<std::shared_ptr<const Content>>(made));
    entries_.push_back(std::move(entry));
    return true;
  }
  /// Returns true while a computation runs or waits for its turn.
  [[nodiscard]] bool is_busy() const { return coming_.valid() || rests_; }
  /// Returns the error message for the wish of the last get().
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr std::size_t kMostEntries = 4;
  static constexpr std::chrono::milliseconds kPatience{500};

  struct Entry {
    Wish wish;
    std::weak_ptr<const VolumeGrid> grid;  // from which the content comes
    std::shared_ptr<const Content> content;
    std::string problem;
  };

  void begin(const Grid& grid, const Wish& wish, Make make, Clock::time_point now) {
    rests_ = false;
    coming_wish_ = wish;
    coming_grid_ = grid;
    begun_ = wished_ = now;
    progress_ = std::make_shared<Progress>();
    coming_ = std::async(std::launch::async, [make = std::move(make), grid, wish, progress = progress_] {
      return make(grid, wish, *progress);
    });
  }

  std::vector<Entry> entries_;         // the last one was used last
  std::weak_ptr<const Content> last_;  // the last one that was computed
  std::string problem_;
  std::shared_ptr<Progress> progress_;
  std::future<DerivedContent<Content>> coming_;
  Wish coming_wish_{};
  std::weak_ptr<const VolumeGrid> coming_grid_;
  Clock::time_point begun_, ended_, wished_;
  Clock::duration took_{};
  bool rests_ = false;
};

}  // namespace gs::app
