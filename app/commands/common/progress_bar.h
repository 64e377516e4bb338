#pragma once

#include "base/parallel.h"

#include <thread>

namespace gs::app {

/// Progress display of a long operation on standard error, if that is a terminal: stage and percent. While it exists,
/// Ctrl-C cancels the operation; a second Ctrl-C ends the program. Only one at a time.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Returns the progress of the whole operation.
  [[nodiscard]] Progress& whole() { return whole_; }
  /// Returns the progress of a part of the operation; cancelled together with it.
  [[nodiscard]] Progress& part() { return part_; }
  [[nodiscard]] bool cancelled() const { return whole_.cancelled; }

 private:
  void draw();

  Progress whole_, part_;
  std::jthread thread_;  // last member: joined before the members that it uses are destroyed
};

}  // namespace gs::app
