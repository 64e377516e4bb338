#pragma once

#include "app/session/documents/series.h"
#include "app/session/viewports/panes.h"
#include "app/session/viewports/step.h"

#include <cstddef>
#include <optional>
#include <string>

namespace gs::app {

/// Playback of the series of numbered files in the active viewport. Without a series there, all functions do nothing.
/// One thread.
class SeriesPlayback {
 public:
  SeriesPlayback(StepContext& step, Panes& panes) : step_(step), panes_(panes) {}

  void play(bool on);
  /// Shows the file at an index of the series.
  void show(std::size_t file);
  /// Sets the playback rate in files per second.
  void set_rate(double rate) { list_.set_rate(name(), rate); }
  /// Returns the earliest time at which a playing series shows its next file; nullopt if no series plays.
  [[nodiscard]] std::optional<double> next_due() const { return list_.next_due(); }
  /// Returns the series in the active viewport; null if there is none.
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
