#pragma once

#include "qnv/lod/lod.h"

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
  /// From where the stream is looked at now; nothing when that is what it was the last time.
  [[nodiscard]] bool take_views(std::vector<qnv::LodView>& views);

  // The drawing thread.
  /// Gives the stream what has come. True when there was something.
  bool apply();
  /// Why no more can be had; once.
  [[nodiscard]] std::string take_problem();
  /// To be called after a picture: what its cuts lacked is what will be read.
  void ask();

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

  std::mutex mutex_;  // guards all below
  std::vector<std::byte> front_, directory_;
  std::vector<Chunk> chunks_;
  std::vector<qnv::ChunkRange> wanted_;
  std::string problem_;
  std::vector<qnv::LodView> views_;
  bool wanted_is_new_ = false, views_are_new_ = false, finished_ = false;
};

}  // namespace gs::app
