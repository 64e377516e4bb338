#pragma once

#include "base/noncopyable.h"
#include "base/parallel.h"

#include <string>
#include <thread>

namespace gs::app {

/// Progress of a long operation, as stage and percent on standard error. Shown only on a terminal. With `lines`, other
/// outputs get a line every few seconds. While the object exists, Ctrl-C cancels the operation, and a second Ctrl-C
/// ends the program. Only one object may exist at a time.
class ProgressBar : NonCopyable {
 public:
  explicit ProgressBar(bool lines = false);
  ~ProgressBar();

  /// Returns the progress of the whole operation, for its code to update.
  [[nodiscard]] Progress& whole() { return whole_; }
  /// Returns the progress of one part of the operation. Cancellation applies to both.
  [[nodiscard]] Progress& part() { return part_; }
  /// Removes the line from the terminal. Ctrl-C then no longer cancels.
  void hide();
  [[nodiscard]] bool cancelled() const { return whole_.cancelled; }

 private:
  [[nodiscard]] std::string text(int width) const;

  Progress whole_, part_;
  std::jthread thread_;  // last member, so that the thread ends before the others are destroyed
};

}  // namespace gs::app
