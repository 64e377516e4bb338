#pragma once

#include "app/view/navigation.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// History of one viewport: files, and positions in them that links led to. Works like the history of a web browser.
/// Bookkeeping only.
class TravelHistory {
 public:
  static constexpr std::size_t kMaxVisits = 200;  // older visits are dropped

  struct Visit {
    std::string path;
    std::optional<Pose> pose;  // pose when the viewer left; nullopt means the initial view
  };

  /// Records a new visit. `left` is the pose of the viewer until now.
  void visit(std::string path, const std::optional<Pose>& left);
  /// Moves back (-1) or forward (1). Returns nullopt if there is no such visit.
  [[nodiscard]] std::optional<Visit> go(int direction, const std::optional<Pose>& left);
  [[nodiscard]] bool can_go(int direction) const;
  /// Returns the current or pending file, or an empty string.
  [[nodiscard]] std::string_view current() const;

 private:
  std::vector<Visit> visits_;
  std::size_t at_ = 0;
};

}  // namespace gs::app
