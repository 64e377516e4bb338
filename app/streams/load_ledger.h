#pragma once

#include "vrml/scene/field_value.h"

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

/// Progress of a file or stream of a world.
enum class LoadStage : std::uint8_t {
  waiting,    // nothing was received
  arriving,   // partly received, or views request more when they need it
  whole,      // completely received
  failed,     // the rest cannot be received
  cancelled,  // the user cancelled the rest
};
[[nodiscard]] std::string_view name_of(LoadStage stage);

/// File or stream that a world reads or has read.
struct LoadRow {
  std::uint64_t number = 0;
  std::string url;   // without secrets
  std::string kind;  // "file", "data", "http", "https", "cells", ...
  LoadStage stage = LoadStage::waiting;
  std::string why;  // reason why it failed or is incomplete
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;
  std::uint64_t datagrams = 0, lost = 0;  // of cells
  bool by_view = false;                   // views choose the parts to read
  double began = 0;                       // seconds since the world was requested
  std::optional<double> first_picture;    // seconds from `began` until its first part was visible
  std::optional<double> ended;            // seconds since the world was requested
  const vrml::Node* node = nullptr;       // the node that needs it, only for comparison; null if none or several do
  const StreamFeed* feed = nullptr;       // feed of a growing stream, only for comparison
};

/// Progress of the files and streams of a world. The loader writes it, and the interface reads it. Bounded: of many
/// ended rows, the newest are kept. Any thread.
class LoadLedger {
 public:
  static constexpr std::size_t kMax = 2000;

  // For the loader.
  using Clock = std::chrono::steady_clock;
  std::uint64_t begin(std::string url, std::string kind, const vrml::Node* node);
  /// Records that another candidate URL of the resource is tried.
  void seek(std::uint64_t number, std::string url, std::string kind);
  void receive(std::uint64_t number, std::uint64_t bytes, std::optional<std::uint64_t> total);
  void count_datagrams(std::uint64_t number, std::uint64_t datagrams, std::uint64_t lost);
  /// Marks a stream that grows. `by_view` is true if views choose the parts to read from now on.
  void follow(std::uint64_t number, const StreamFeed* feed, bool by_view);
  void show(std::uint64_t number);
  void end(std::uint64_t number, LoadStage stage, std::string why = {});
  /// Returns the rows that the user cancelled since the last call.
  [[nodiscard]] std::vector<std::uint64_t> take_cancelled();
  /// Returns the last value of `set_rate`, or nullopt if it was not called.
  [[nodiscard]] std::optional<std::uint64_t> rate() const;
  /// Sets a function to call after `cancel` and `set_rate`.
  void set_wake(std::function<void()> wake);

  // For the interface.
  /// Returns the rows in the order in which they began.
  [[nodiscard]] std::vector<LoadRow> rows() const;
  void cancel(std::uint64_t number);
  /// Returns the bytes received over the network, for all rows so far.
  [[nodiscard]] std::uint64_t received() const;
  /// Limits the total bandwidth from now on, in bits per second; 0 means unlimited.
  void set_rate(std::uint64_t bits_a_second);

 private:
  LoadRow* find(std::uint64_t number);
  [[nodiscard]] double now() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }

  const Clock::time_point begun_ = Clock::now();
  mutable std::mutex mutex_;  // guards all members below
  std::deque<LoadRow> rows_;  // by number
  std::uint64_t numbers_ = 0;
  std::uint64_t received_ = 0;
  std::optional<std::uint64_t> rate_;
  std::vector<std::uint64_t> cancelled_;
  std::function<void()> wake_;
};

}  // namespace gs::app
