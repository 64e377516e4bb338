#pragma once

#include "qnv/base/parallel.h"

#include <thread>

namespace gs::app {

/// What a long piece of work shows on stderr when that is a terminal: stage and percent. As long as it lives, Ctrl-C
/// cancels the work; a second one ends the program. One at a time.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For the work as a whole.
  [[nodiscard]] qnv::Progress& whole() { return whole_; }
  /// For work that the whole has done for it; cancelled with it.
  [[nodiscard]] qnv::Progress& part() { return part_; }
  [[nodiscard]] bool cancelled() const { return whole_.cancelled; }

 private:
  void draw();

  qnv::Progress whole_, part_;
  std::jthread thread_;  // last: joined before what it uses goes
};

}  // namespace gs::app
