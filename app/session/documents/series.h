#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Series of files that are opened by one name, such as "run.%04d.vti", and how they play: plain bookkeeping, without
/// reading any. Times are those of the session, in seconds.
class SeriesList {
 public:
  struct Series {
    std::vector<std::string> files;  // in the order of their numbers, at least one
    std::size_t wanted = 0;          // the one that is read, or shows
    std::size_t shown = 0;
    bool playing = false;
    double rate = 25;  // files a second
    double due = 0;    // when `wanted` is to show
  };

  /// The file that is to be read for a name; the name itself where it is no series. Looks for the files of a series
  /// when it hears of it first.
  [[nodiscard]] std::string file_of(const std::string& name);
  /// Null: the name is no series.
  [[nodiscard]] Series* find(const std::string& name);
  [[nodiscard]] const Series* find(const std::string& name) const;

  /// True while what has been read of a series waits for its time.
  [[nodiscard]] bool holds_back(const std::string& name, double now) const;
  /// The file that was wanted shows now. True where the next one is wanted: it is read ahead.
  bool arrived(const std::string& name, double now);
  /// These return true where another file is wanted than before.
  bool play(const std::string& name, bool on, double now);
  bool show(const std::string& name, std::size_t file, double now);
  void set_rate(const std::string& name, double rate);
  /// When the next file is due of those that play; nothing: none does.
  [[nodiscard]] std::optional<double> next_due() const;

 private:
  std::map<std::string, Series> series_;
};

}  // namespace gs::app
