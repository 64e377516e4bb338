#pragma once

#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/viewed_stream.h"

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

/// Hand-over between reader thread and drawing thread for one stream. Passes wanted chunks and views to the reader
/// thread. If the drawing thread decodes the stream, also passes received bytes to that thread.
class StreamFeed {
 public:
  /// Creates a feed. The drawing thread decodes a ViewedStream, and calls `wake` when it wants other chunks. The reader
  /// thread decodes the streams of other `requests`, which must be safe for any thread.
  StreamFeed(std::shared_ptr<qnv::ChunkRequests> requests, std::function<void()> wake);

  // Functions for any thread.
  // Returns true if the drawing thread decodes the stream, and the feed passes the bytes.
  [[nodiscard]] bool takes_bytes() const { return stream_ != nullptr; }
  /// Returns the bounds of the stream, in the coordinates of the views.
  [[nodiscard]] const Box& box() const { return requests_->box(); }
  /// Returns the offset of the stream's directory. 0 means unknown.
  [[nodiscard]] std::uint64_t directory() const { return requests_->directory(); }
  [[nodiscard]] const std::shared_ptr<qnv::ChunkRequests>& requests() const { return requests_; }

  // Functions for the reader thread.
  // Adds the next bytes of a stream that is read from front to back.
  void push(std::span<const std::byte> bytes);
  /// Adds all directory chunks of the stream. Returns false if the chunks are known to be invalid.
  bool set_directory(std::vector<std::byte> chunks);
  /// Adds a complete chunk. `offset` is its position in the stream.
  void add(std::uint64_t offset, std::vector<std::byte> chunk);
  /// Adds a complete chunk with an unknown offset. `number` identifies the chunk.
  void add_loose(std::uint32_t number, std::vector<std::byte> chunk);
  /// Marks the stream as completely received.
  void finish();
  /// Marks the stream as failed: no more bytes follow. `why` is the reason.
  void fail(std::string why);
  /// Copies the chunks that views want to `ranges`, the most wanted first. Returns false if they have not changed since
  /// the last call.
  [[nodiscard]] bool take_wanted(std::vector<qnv::ChunkRange>& ranges);
  /// Returns the weight that set_weight() has set.
  [[nodiscard]] double weight() const { return weight_; }
  /// Copies the views that show the stream to `views`. Returns false if they have not changed since the last call.
  [[nodiscard]] bool take_views(std::vector<qnv::LodView>& views);

  // Functions for the drawing thread.
  // Passes received bytes to the stream. Returns true if there were any.
  bool apply();
  /// Returns the number of calls of `apply` that returned true.
  [[nodiscard]] std::uint64_t applied() const { return applied_; }
  /// Returns the reason of fail(), the first time; else an empty string.
  [[nodiscard]] std::string take_problem();
  /// Requests the chunks that the last cuts lacked. Call after each picture.
  void ask();
  /// Drops the wanted chunks of a viewport, because it no longer shows the stream.
  void forget(std::uint32_t viewport) { requests_->forget(viewport); }
  /// Sets the bandwidth of this stream relative to that of the most important stream: above 0, at most 1.
  void set_weight(double weight) { weight_ = weight; }
  /// Returns true if views lack chunks that may still be received.
  [[nodiscard]] bool reading() const { return !asked_.empty() && !over_; }

  /// Returns the octree stream if the drawing thread decodes it, else null.
  [[nodiscard]] const qnv::LodStream* stream() const { return dynamic_cast<const qnv::LodStream*>(stream_.get()); }
  /// Returns the stream of Gaussians if the drawing thread decodes it, else null.
  [[nodiscard]] const qnv::SplatStream* splats() const { return dynamic_cast<const qnv::SplatStream*>(stream_.get()); }

 private:
  struct Chunk {
    std::uint64_t offset = 0;
    std::vector<std::byte> bytes;
  };
  std::shared_ptr<qnv::ChunkRequests> requests_;
  std::shared_ptr<qnv::ViewedStream> stream_;  // same object as requests_, or null
  std::function<void()> wake_;
  std::vector<qnv::ChunkRange> asked_;  // drawing thread only
  std::vector<qnv::LodView> told_;      // drawing thread only
  std::uint64_t applied_ = 0;           // drawing thread only
  std::atomic<double> weight_ = 1;
  std::atomic<bool> over_ = false;  // complete or failed

  std::mutex mutex_;  // guards all members below
  std::vector<std::byte> front_, directory_;
  std::vector<Chunk> chunks_;
  std::vector<qnv::ChunkRange> wanted_;
  std::string problem_;
  std::vector<qnv::LodView> views_;
  bool wanted_is_new_ = false, views_are_new_ = false, finished_ = false;
};

}  // namespace gs::app
