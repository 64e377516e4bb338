#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gs::app {

/// Short lines that are shown for a while and go away by themselves, one below the other: a new one takes the place of
/// none that is still to be read.
class Notices {
 public:
  static constexpr std::size_t kMost = 5;  // at a time; then the oldest goes
  static constexpr double kSeconds = 3.5, kProblemSeconds = 12;

  struct Line {
    std::string text;
    bool is_problem = false;
    double until = 0;
    std::string about = {};
  };

  /// What is shown already stays longer, and is not shown twice. `about`: of what changes step by step, a speed, only
  /// the newest line is shown, and none when its text is empty; empty: of nothing like that.
  void show(std::string text, bool is_problem, double now, std::string_view about = {});
  /// Drops what has been shown long enough.
  void expire(double now);
  void close(std::size_t index);
  /// The newest goes. False when there is none.
  bool close_one();
  void clear() { lines_.clear(); }
  /// Oldest first.
  [[nodiscard]] const std::vector<Line>& lines() const { return lines_; }
  /// When `expire` will drop something.
  [[nodiscard]] std::optional<double> next() const;

 private:
  std::vector<Line> lines_;
};

}  // namespace gs::app
