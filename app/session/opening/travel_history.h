#pragma once

#include "app/view/navigation.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// History of one viewport, like that of a web browser. Its entries are files, and positions in files to which links
/// led. Bookkeeping only.
class TravelHistory {
 public:
  static constexpr std::size_t kMaxVisits = 200;  // max visits; the oldest are dropped

  struct Visit {
    std::string path;
    std::optional<Pose> pose;  // pose of the viewer at the end of the visit; nullopt means the initial view
  };

  /// Records a new visit. `left` is the viewer's pose at the end of the previous visit.
  void visit(std::string path, const std::optional<Pose>& left);
  /// Goes back (-1) or forward (1). `left` is the viewer's present pose. Returns the visit to restore; nullopt if there
  /// is none.
  [[nodiscard]] std::optional<Visit> go(int direction, const std::optional<Pose>& left);
  [[nodiscard]] bool can_go(int direction) const;
  /// Returns the path of the current or pending visit; empty if there is none.
  [[nodiscard]] std::string_view current() const;

 private:
  std::vector<Visit> visits_;
  std::size_t at_ = 0;
};

}  // namespace gs::app
