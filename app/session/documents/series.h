#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Playback state of all series. A series consists of numbered files that are opened by one name, such as
/// "run.%04d.vti", or of the steps of one file. Bookkeeping only: reads no contents. All times are session times in
/// seconds.
class SeriesList {
 public:
  struct Series {
    std::vector<std::string> files;  // paths in the order of their numbers; at least one
    std::size_t wanted = 0;          // index of the file that is shown or being read for display
    std::size_t shown = 0;
    bool playing = false;
    double rate = 25;  // files per second
    double due = 0;    // time from which `wanted` may be shown
    std::vector<double> times{};  // of the steps of a single file; then `files` has its name once per step
  };

  /// Returns the path of the file to read for a name. For a name that is no series, returns the name itself. The first
  /// call for a name searches the folder for its files.
  [[nodiscard]] std::string file_of(const std::string& name);
  /// Searches the folder of a series for further files. With `newest`, the last one is wanted. Returns true if there
  /// are more.
  bool refresh(const std::string& name, bool newest);
  /// Returns the series of a name, or null if the name is not a series.
  [[nodiscard]] Series* find(const std::string& name);
  [[nodiscard]] const Series* find(const std::string& name) const;

  /// Makes a series of the steps of a file with a changing surface. `shown` is the step that was read.
  void set_steps(const std::string& name, const std::vector<double>& times, std::size_t shown);
  /// Returns the step of the file to read for a name; nullopt without such steps.
  [[nodiscard]] std::optional<std::size_t> step_of(const std::string& name) const;

  /// Returns true if the wanted file of a series must not be shown before a later time.
  [[nodiscard]] bool holds_back(const std::string& name, double now) const;
  /// Records that the wanted file is shown. Returns true if the series is playing; then the next file is wanted and
  /// should be read in advance.
  bool arrived(const std::string& name, double now);
  /// Starts or stops playing a series. Like show(), returns true if another file is wanted now.
  bool play(const std::string& name, bool on, double now);
  bool show(const std::string& name, std::size_t file, double now);
  void set_rate(const std::string& name, double rate);
  /// Returns the earliest time at which a playing series shows its next file, or nullopt if none plays.
  [[nodiscard]] std::optional<double> next_due() const;

 private:
  std::map<std::string, Series> series_;
};

}  // namespace gs::app
