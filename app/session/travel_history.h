#pragma once

#include "app/view/navigation.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Where the viewer of one viewport has been: files, and places in them that links led to. As in a web browser: who
/// goes back may go forward again, until he goes elsewhere. Pure bookkeeping.
class TravelHistory {
 public:
  static constexpr std::size_t kMostVisits = 200;  // then the oldest are forgotten

  struct Visit {
    std::string path;
    std::optional<Pose> pose;  // where he stood when he left; nothing: where the file is entered
  };

  /// He is somewhere else; `left`: where he stood until now.
  void visit(std::string path, const std::optional<Pose>& left);
  /// Back (-1) or forward (1) from where he stands. Nothing: there is no such place.
  [[nodiscard]] std::optional<Visit> go(int direction, const std::optional<Pose>& left);
  [[nodiscard]] bool can_go(int direction) const;
  /// The file where he is, or on his way to; empty: none yet.
  [[nodiscard]] std::string_view current() const;

 private:
  std::vector<Visit> visits_;
  std::size_t at_ = 0;
};

}  // namespace gs::app
