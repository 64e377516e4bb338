#pragma once

#include "vrml/scene/values/field_value.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace gs::vrml {
class SceneGraph;
struct Node;
}  // namespace gs::vrml

namespace gs::app {

class StreamFeed;

/// Stage in the loading of a file or stream.
enum class LoadStage : std::uint8_t {
  waiting,    // nothing is received yet
  arriving,   // a part is received; for streams, views may request more
  whole,      // completely received
  failed,     // incomplete, because of an error
  cancelled,  // incomplete, because the user cancelled loading
};
[[nodiscard]] std::string_view name_of(LoadStage stage);

/// Transfer of a stream as cells.
struct CellCounts {
  std::uint64_t datagrams = 0, lost = 0;  // received and lost datagrams
  std::uint64_t granted = 0, rate = 0;    // bits per second that the server granted, and that it sends after losses
  double loss_events = 0;                 // loss events per datagram; these reduce the rate (RFC 5348)
  bool missing = false;                   // the server has sent everything, but lost data are missing
};

/// File or stream of a world, with the progress of its loading.
struct LoadRow {
  std::uint64_t number = 0;
  std::string url;   // URL without passwords and tokens
  std::string kind;  // "file", "data", "http", "https", "cells", ...
  LoadStage stage = LoadStage::waiting;
  std::string why;  // error, or reason why it is incomplete
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;
  CellCounts cells;
  bool by_view = false;                 // views choose which parts are read
  double began = 0;                     // start, in seconds after the world was requested
  std::optional<double> first_picture;  // seconds from `began` until the first part was visible
  std::optional<double> ended;          // end, in seconds after the world was requested
  const vrml::Node* node = nullptr;     // node that refers to the resource, or null; do not dereference
  const StreamFeed* feed = nullptr;     // feed of a stream that grows; do not dereference
};

/// Progress of all files and streams of a world. The loader writes it, the interface reads it. If there are too many
/// rows, the oldest ended ones are removed. Any thread.
class LoadLedger {
 public:
  static constexpr std::size_t kMax = 2000;

  // Functions for the loader.
  using Clock = std::chrono::steady_clock;
  std::uint64_t begin(std::string url, std::string kind, const vrml::Node* node);
  /// Notes the candidate URL that is tried now.
  void seek(std::uint64_t number, std::string url, std::string kind);
  void receive(std::uint64_t number, std::uint64_t bytes, std::optional<std::uint64_t> total);
  void count_cells(std::uint64_t number, const CellCounts& counts);
  /// Marks a row as a stream that grows. If `by_view` is true, views choose from now on which parts are read.
  void follow(std::uint64_t number, const StreamFeed* feed, bool by_view);
  void show(std::uint64_t number);
  void end(std::uint64_t number, LoadStage stage, std::string why = {});
  /// Returns the numbers of the rows that the user has cancelled since the last call.
  [[nodiscard]] std::vector<std::uint64_t> take_cancelled();
  /// Returns the last value of `set_rate`, or nullopt before the first.
  [[nodiscard]] std::optional<std::uint64_t> rate() const;
  /// Sets a function to call after each `cancel` and `set_rate`.
  void set_wake(std::function<void()> wake);

  // Functions for the interface.
  // Returns the rows in the order of their start.
  [[nodiscard]] std::vector<LoadRow> rows() const;
  void cancel(std::uint64_t number);
  /// Returns the number of bytes that all rows so far have received over the network.
  [[nodiscard]] std::uint64_t received() const;
  /// Sets the limit of the total bandwidth, in bits per second. 0 means unlimited.
  void set_rate(std::uint64_t bits_a_second);

 private:
  LoadRow* find(std::uint64_t number);
  [[nodiscard]] double now() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }

  const Clock::time_point begun_ = Clock::now();
  mutable std::mutex mutex_;  // guards all members below
  std::deque<LoadRow> rows_;  // in ascending order of their numbers
  std::uint64_t numbers_ = 0;
  std::uint64_t received_ = 0;
  std::optional<std::uint64_t> rate_;
  std::vector<std::uint64_t> cancelled_;
  std::function<void()> wake_;
};

}  // namespace gs::app
