#pragma once

#include "qnv/lod/lod.h"

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

/// Carries what arrives of a stream from the thread that reads to the one that draws, and back what the views there
/// want. The stream itself is the drawing thread's alone.
class StreamFeed {
 public:
  /// `wake` tells the reading thread that other bytes are wanted; called on the drawing thread.
  StreamFeed(std::shared_ptr<qnv::LodStream> stream, std::function<void()> wake);

  // The reading thread.
  /// The next bytes of a stream that comes from front to back.
  void push(std::span<const std::byte> bytes);
  /// All directory chunks of the stream.
  void set_directory(std::vector<std::byte> chunks);
  /// A whole chunk and its place in the stream.
  void add(std::uint64_t offset, std::vector<std::byte> chunk);
  /// A whole chunk of which only its number is known.
  void add_loose(std::uint32_t number, std::vector<std::byte> chunk);
  /// No more comes.
  void finish();
  /// Nothing more can be had.
  void fail(std::string why);
  /// What views want now, most wanted first; nothing when that is what it was the last time.
  [[nodiscard]] bool take_wanted(std::vector<qnv::ChunkRange>& ranges);
  /// How much of the line it gets beside other streams, as `set_weight` said last.
  [[nodiscard]] double weight() const { return weight_; }
  /// From where the stream is looked at now; nothing when that is what it was the last time.
  [[nodiscard]] bool take_views(std::vector<qnv::LodView>& views);

  // The drawing thread.
  /// Gives the stream what has come. True when there was something.
  bool apply();
  /// How often there was.
  [[nodiscard]] std::uint64_t applied() const { return applied_; }
  /// Why no more can be had; once.
  [[nodiscard]] std::string take_problem();
  /// To be called after a picture: what its cuts lacked is what will be read.
  void ask();
  /// A viewport that does not look any more: what it lacked is not wanted for it.
  void forget(std::uint32_t viewport) { stream_->forget(viewport); }
  /// Of what is read for several viewports it gets so much, times what the most favoured one does: above 0, to 1.
  void set_weight(double weight) { weight_ = weight; }
  /// Views lack something of it that may still come.
  [[nodiscard]] bool reading() const { return !asked_.empty() && !over_; }

  [[nodiscard]] const qnv::LodStream* stream() const { return stream_.get(); }

 private:
  struct Chunk {
    std::uint64_t offset = 0;
    std::vector<std::byte> bytes;
  };
  std::shared_ptr<qnv::LodStream> stream_;
  std::function<void()> wake_;
  std::vector<qnv::ChunkRange> asked_;  // the drawing thread's
  std::vector<qnv::LodView> told_;      // likewise
  std::uint64_t applied_ = 0;           // likewise
  std::atomic<double> weight_ = 1;
  std::atomic<bool> over_ = false;  // nothing more comes, or can be had

  std::mutex mutex_;  // guards all below
  std::vector<std::byte> front_, directory_;
  std::vector<Chunk> chunks_;
  std::vector<qnv::ChunkRange> wanted_;
  std::string problem_;
  std::vector<qnv::LodView> views_;
  bool wanted_is_new_ = false, views_are_new_ = false, finished_ = false;
};

}  // namespace gs::app
