#pragma once

#include "app/formats/splats/splat_edit.h"
#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "base/box.h"
#include "base/noncopyable.h"
#include "qnv/base/geometry.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

struct Document;

/// Gaussian splats of a world that has no other content.
struct OnlySplats {
  ResourceUpdates::Place place;  // the QNV node
  std::shared_ptr<const qnv::Geometry> geometry;
};
/// Returns the splats of a world that is a file of splats. Returns nullopt for all other worlds.
[[nodiscard]] std::optional<OnlySplats> only_splats(const LoadedWorld& world);

/// Extent of splats before any edit, for the ranges of controls.
struct SplatExtent {
  WideBox whole;      // of all centres, in source coordinates
  WideBox middle;     // from the 1st to the 99th percentile of each coordinate, with a margin
  float largest = 0;  // longest standard deviation
};

/// Edit of the splats of a file by the user, its history, and the edited splats in the world. World's thread. A
/// background thread makes new splats; until then, the world shows the previous ones. The destructor waits for it.
class SplatEdits : NonCopyable {
 public:
  [[nodiscard]] const SplatEdit& edit() const { return edit_; }
  /// Sets the edit. Changes with one `gesture` are undone together; 0 means no gesture. `time`: seconds since 1970.
  void set(const SplatEdit& edit, double time, std::uint64_t gesture = 0);
  /// Undoes (-1) or redoes (1) the last change.
  void go(int direction);
  /// Returns the time of the change that go() would undo or redo; nullopt if there is none.
  [[nodiscard]] std::optional<double> time_of(int direction) const;

  /// Returns true if the edit differs from the saved one.
  [[nodiscard]] bool unsaved() const { return edit_ != saved_; }
  void mark_saved(const SplatEdit& saved) { saved_ = saved; }

  /// Makes the world show the edited splats once they are ready. Call in each step. Returns true
  /// if the world or the problem changed. The background thread calls `wake` when splats are ready.
  bool follow(Document& document, const std::function<void()>& wake);
  /// Returns true while the background thread makes edited splats.
  [[nodiscard]] bool busy() const { return coming_.valid(); }
  /// Returns the numbers of splats that the last finished edit removed.
  [[nodiscard]] const SplatsRemoved& removed() const { return removed_; }
  /// Returns the reason why the edit is not shown; empty if there is none.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  /// Returns the extent of the unedited splats of `world`. A background thread computes the extent of many splats;
  /// until it is done, returns the previous extent.
  [[nodiscard]] const SplatExtent& extent(const LoadedWorld& world);

 private:
  using Shared = std::shared_ptr<const qnv::Geometry>;
  static constexpr std::size_t kMostUndone = 1000;
  struct Change {
    SplatEdit before, after;
    double time = 0;
    std::uint64_t gesture = 0;
  };
  struct Made {
    Shared geometry;  // null if there is not enough memory
    std::weak_ptr<const qnv::Geometry> of;
    SplatEdit edit;
    SplatsRemoved removed;
  };
  void begin(Document& document, std::function<void()> wake);
  void show(Document& document, const OnlySplats& place, Shared geometry, const SplatEdit& edit);

  SplatEdit edit_, saved_;
  std::vector<Change> done_, undone_;  // the next change to undo or redo is the last one
  Shared original_, shown_;            // splats without and with the edit `made_`
  SplatEdit made_;
  std::optional<SplatEdit> failed_;
  SplatsRemoved removed_;
  std::string problem_;
  SplatExtent extent_;
  std::weak_ptr<const qnv::Geometry> extent_of_;
  std::future<SplatExtent> extent_coming_;
  std::atomic<bool> came_ = false;  // `coming_` is ready, or returns at once
  std::future<Made> coming_;
};

}  // namespace gs::app
