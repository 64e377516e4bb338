#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Stack of notices (toasts), each with an expiry time. A new notice does not replace older ones.
class Notices {
 public:
  static constexpr std::size_t kMax = 5;  // max notices at a time; beyond it, the oldest is removed
  static constexpr double kSeconds = 3.5, kProblemSeconds = 12;

  struct Line {
    std::string text;
    bool is_problem = false;
    double until = 0;
    std::string about = {};
  };

  /// Shows a notice. If a notice with equal text is visible, extends its time instead. `about` names a value that
  /// changes in steps, such as speed: a new notice replaces the previous one with the same `about`, and an empty text
  /// removes it. With an empty `about`, replaces no other notice.
  void show(std::string text, bool is_problem, double now, std::string_view about = {});
  /// Removes expired notices.
  void expire(double now);
  void close(std::size_t index);
  /// Removes the newest notice. Returns false if there is none.
  bool close_one();
  void clear() { lines_.clear(); }
  /// Returns the notices, oldest first.
  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }
  /// Returns the time of the next expiry; nullopt if there are no notices.
  [[nodiscard]] std::optional<double> next() const;

 private:
  std::vector<Line> lines_;
};

}  // namespace gs::app
