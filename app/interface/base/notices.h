#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Stack of notices (toasts) that disappear after a while. A new one does not replace an unread one.
class Notices {
 public:
  static constexpr std::size_t kMax = 5;  // max at a time; then the oldest is removed
  static constexpr double kSeconds = 3.5, kProblemSeconds = 12;

  struct Line {
    std::string text;
    bool is_problem = false;
    double until = 0;
    std::string about = {};
  };

  /// Shows a notice. An equal one already shown stays longer instead. `about` groups notices of a value that changes in
  /// steps, such as speed: only the newest is shown, and an empty text removes it. An empty `about` means no group.
  void show(std::string text, bool is_problem, double now, std::string_view about = {});
  /// Removes expired notices.
  void expire(double now);
  void close(std::size_t index);
  /// Removes the newest notice. Returns false if there is none.
  bool close_one();
  void clear() { lines_.clear(); }
  /// Returns the notices, oldest first.
  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }
  /// Returns the time of the next expiry.
  [[nodiscard]] std::optional<double> next() const;

 private:
  std::vector<Line> lines_;
};

}  // namespace gs::app
