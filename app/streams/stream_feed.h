#pragma once

#include "qnv/codecs/octree/lod/lod.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Hand-over of one stream: passes received bytes from the reader thread to the drawing thread, and wanted chunks back.
/// Only the drawing thread uses the stream itself.
class StreamFeed {
 public:
  /// Creates a feed. `wake` is called on the drawing thread when other bytes are wanted.
  StreamFeed(std::shared_ptr<qnv::LodStream> stream, std::function<void()> wake);

  // For the reader thread.
  /// Adds the next bytes of a stream that is read front to back.
  void push(std::span<const std::byte> bytes);
  /// Sets all directory chunks of the stream.
  void set_directory(std::vector<std::byte> chunks);
  /// Adds a complete chunk with its offset in the stream.
  void add(std::uint64_t offset, std::vector<std::byte> chunk);
  /// Adds a complete chunk that is identified only by its number.
  void add_loose(std::uint32_t number, std::vector<std::byte> chunk);
  /// Marks the stream as complete.
  void finish();
  /// Marks the rest of the stream as unavailable.
  void fail(std::string why);
  /// Stores the chunks that views want in `ranges`, most wanted first. Returns false if they have not changed.
  [[nodiscard]] bool take_wanted(std::vector<qnv::ChunkRange>& ranges);
  /// Returns the last value of `set_weight`.
  [[nodiscard]] double weight() const { return weight_; }
  /// Stores the views that see the stream in `views`. Returns false if they have not changed.
  [[nodiscard]] bool take_views(std::vector<qnv::LodView>& views);

  // For the drawing thread.
  /// Passes received data to the stream. Returns true if there was any.
  bool apply();
  /// Returns the number of calls of `apply` that had data.
  [[nodiscard]] std::uint64_t applied() const { return applied_; }
  /// Returns the reason why no more can be read, once.
  [[nodiscard]] std::string take_problem();
  /// Requests the chunks that the last cuts lacked. Call after each picture.
  void ask();
  /// Forgets the wanted chunks of a viewport that no longer shows the stream.
  void forget(std::uint32_t viewport) { stream_->forget(viewport); }
  /// Sets the bandwidth share relative to the most favoured stream, above 0 and up to 1.
  void set_weight(double weight) { weight_ = weight; }
  /// Returns true if views lack parts that may still be received.
  [[nodiscard]] bool reading() const { return !asked_.empty() && !over_; }

  [[nodiscard]] const qnv::LodStream* stream() const { return stream_.get(); }

 private:
  struct Chunk {
    std::uint64_t offset = 0;
    std::vector<std::byte> bytes;
  };
  std::shared_ptr<qnv::LodStream> stream_;
  std::function<void()> wake_;
  std::vector<qnv::ChunkRange> asked_;  // drawing thread only
  std::vector<qnv::LodView> told_;      // drawing thread only
  std::uint64_t applied_ = 0;           // drawing thread only
  std::atomic<double> weight_ = 1;
  std::atomic<bool> over_ = false;  // no more data can be received

  std::mutex mutex_;  // guards all members below
  std::vector<std::byte> front_, directory_;
  std::vector<Chunk> chunks_;
  std::vector<qnv::ChunkRange> wanted_;
  std::string problem_;
  std::vector<qnv::LodView> views_;
  bool wanted_is_new_ = false, views_are_new_ = false, finished_ = false;
};

}  // namespace gs::app
