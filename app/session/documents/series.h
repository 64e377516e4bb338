#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Playback state of series of files that are opened by one name, such as "run.%04d.vti". Bookkeeping only: reads no
/// contents. Times are those of the session, in seconds.
class SeriesList {
 public:
  struct Series {
    std::vector<std::string> files;  // ordered by number; at least one
    std::size_t wanted = 0;          // the file that is being read or is shown
    std::size_t shown = 0;
    bool playing = false;
    double rate = 25;  // files per second
    double due = 0;    // time at which `wanted` is to be shown
  };

  /// Returns the file to read for a name, or the name itself if it is not a series. The first call searches for the
  /// files of the series.
  [[nodiscard]] std::string file_of(const std::string& name);
  /// Returns the series of a name, or null if the name is not a series.
  [[nodiscard]] Series* find(const std::string& name);
  [[nodiscard]] const Series* find(const std::string& name) const;

  /// Returns true while a file of a series is loaded but must not be shown yet.
  [[nodiscard]] bool holds_back(const std::string& name, double now) const;
  /// Marks the wanted file as shown. Returns true if the next file is now wanted and should be read ahead.
  bool arrived(const std::string& name, double now);
  /// These functions return true if the wanted file changed.
  bool play(const std::string& name, bool on, double now);
  bool show(const std::string& name, std::size_t file, double now);
  void set_rate(const std::string& name, double rate);
  /// Returns the earliest time at which a playing series shows its next file, or nullopt if none plays.
  [[nodiscard]] std::optional<double> next_due() const;

 private:
  std::map<std::string, Series> series_;
};

}  // namespace gs::app
