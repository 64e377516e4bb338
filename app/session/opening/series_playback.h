#pragma once

#include "app/session/documents/series.h"
#include "app/session/viewports/panes.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <optional>
#include <string>

namespace gs::app {

/// Playback of the series of files in the active viewport. Its functions do nothing if that shows no series. One
/// thread.
class SeriesPlayback {
 public:
  SeriesPlayback(StepContext& step, Panes& panes) : step_(step), panes_(panes) {}

  void play(bool on);
  /// Shows one file of the series.
  void show(std::size_t file);
  /// Sets the files per second.
  void set_rate(double rate) { list_.set_rate(name(), rate); }
  /// Returns the earliest time at which a playing series shows its next file; see SeriesList::next_due().
  [[nodiscard]] std::optional<double> next_due() const { return list_.next_due(); }
  /// Returns the series of the active viewport, or null if it does not show one.
  [[nodiscard]] const SeriesList::Series* current() const { return list_.find(name()); }
  /// Returns all series of the session, by name.
  [[nodiscard]] SeriesList& list() { return list_; }

 private:
  [[nodiscard]] const std::string& name() const { return panes_.at(panes_.active()).wanted; }

  StepContext& step_;
  Panes& panes_;
  SeriesList list_;
};

}  // namespace gs::app
