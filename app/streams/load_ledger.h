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

/// How far a file or stream is that a world reads.
enum class LoadStage : std::uint8_t {
  waiting,    // nothing of it has come
  arriving,   // some of it has, or views ask for more of it as they need it
  whole,      // all is there
  failed,     // what is missing never comes
  cancelled,  // likewise, since nobody wants it
};
[[nodiscard]] std::string_view name_of(LoadStage stage);

/// A file or stream that a world reads, or has read.
struct LoadRow {
  std::uint64_t number = 0;
  std::string url;   // without what is secret in it
  std::string kind;  // "file", "data", "http", "https", "cells", ...
  LoadStage stage = LoadStage::waiting;
  std::string why;  // it failed, or is not all there
  std::uint64_t received = 0;
  std::optional<std::uint64_t> total;
  std::uint64_t datagrams = 0, lost = 0;  // of cells
  bool by_view = false;                   // views say what comes of it
  double began = 0;                       // seconds since the world was asked for
  std::optional<double> first_picture;    // since it began: when the first of it showed
  std::optional<double> ended;            // since the world was asked for
  const vrml::Node* node = nullptr;       // that it is for, only to be compared; null: none, or several
  const StreamFeed* feed = nullptr;       // of a stream that grows, likewise
};

/// The files and streams of a world, for who wants to see how far they are: kept by who reads, told to who asks. What
/// is kept is bounded: of very many files that have ended, the newest. All threads.
class LoadLedger {
 public:
  static constexpr std::size_t kMost = 2000;

  // Who reads.
  using Clock = std::chrono::steady_clock;
  std::uint64_t begin(std::string url, std::string kind, const vrml::Node* node);
  /// Another place where the same may be is tried.
  void seek(std::uint64_t number, std::string url, std::string kind);
  void receive(std::uint64_t number, std::uint64_t bytes, std::optional<std::uint64_t> total);
  void count_datagrams(std::uint64_t number, std::uint64_t datagrams, std::uint64_t lost);
  /// It is a stream that grows; `by_view`: from now on views say what comes of it.
  void follow(std::uint64_t number, const StreamFeed* feed, bool by_view);
  void show(std::uint64_t number);
  void end(std::uint64_t number, LoadStage stage, std::string why = {});
  /// What somebody does not want any more, since the last call.
  [[nodiscard]] std::vector<std::uint64_t> take_cancelled();
  /// What `set_rate` said last; nothing: it was never called.
  [[nodiscard]] std::optional<std::uint64_t> rate() const;
  /// `wake` is called when there is some, or another rate.
  void set_wake(std::function<void()> wake);

  // Who asks.
  /// In the order in which they began.
  [[nodiscard]] std::vector<LoadRow> rows() const;
  void cancel(std::uint64_t number);
  /// Bytes that have come over the network, for all rows that there ever were.
  [[nodiscard]] std::uint64_t received() const;
  /// How fast all of it together may come over the network from now on, bits a second; 0: as fast as it can.
  void set_rate(std::uint64_t bits_a_second);

 private:
  LoadRow* find(std::uint64_t number);
  [[nodiscard]] double now() const { return std::chrono::duration<double>(Clock::now() - begun_).count(); }

  const Clock::time_point begun_ = Clock::now();
  mutable std::mutex mutex_;  // guards all below
  std::deque<LoadRow> rows_;  // by number
  std::uint64_t numbers_ = 0;
  std::uint64_t received_ = 0;
  std::optional<std::uint64_t> rate_;
  std::vector<std::uint64_t> cancelled_;
  std::function<void()> wake_;
};

}  // namespace gs::app
