#pragma once

#include "qnv/codecs/shared/viewed_stream.h"
#include "qnv/codecs/shared/volume_detail.h"
#include "qnv/codecs/values/bricks/brick_decoder.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <span>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Values stream of a volume that is larger than memory. The whole volume is decoded at a coarse level, and bricks of
/// finer levels where views need them. The same bytes and views give the same vectors. The stream is in a file, or
/// still growing; then views request its chunks. While a window draws, another thread decodes. Any thread. Safe for
/// untrusted bytes.
class BrickVolume final : public ViewedStream, public VolumeDetail {
 public:
  using Opened = std::variant<std::shared_ptr<BrickVolume>, StreamProblem>;
  /// Opens a stream in a file. Reads its directory and the chunks of the coarse level now, and others when views need
  /// them. Without a directory, reads the whole stream once. `stop` ends this if it returns true. `step` is that of a
  /// time series.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source, const BrickLimits& limits = {},
                                   const std::function<bool()>& stop = {}, std::uint32_t step = 0);
  /// Opens a growing stream from its first bytes, which must contain the whole header.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front, const BrickLimits& limits = {});
  ~BrickVolume() override;

  /// Reports whether a stream is a volume with more samples than can be decoded for this number of vectors, or a time
  /// series of them. begin() shows its first step.
  [[nodiscard]] static bool suits(const StreamHeader& header, std::size_t most_vectors);

  bool push(std::span<const std::byte> bytes) override;
  void finish() override;
  bool add(std::uint64_t offset, std::span<const std::byte> chunk) override;
  /// Always returns true. Without a usable directory, only the bytes of push() are shown.
  bool set_directory(std::span<const std::byte> chunks) override;

  /// Does nothing, because cut() notes its view.
  void note(const LodView&) override {}
  void forget(std::uint32_t viewport) override;
  [[nodiscard]] std::vector<LodView> views() const override;
  [[nodiscard]] const Box& box() const override { return header_.description.box; }
  [[nodiscard]] std::uint64_t directory() const override { return header_.directory; }
  [[nodiscard]] bool in_stream_order() const override { return false; }
  [[nodiscard]] std::vector<ChunkRange> wanted() const override;

  [[nodiscard]] std::shared_ptr<const Volume> cut(const LodView& view, bool& pending) override;
  [[nodiscard]] std::shared_ptr<const Volume> latest() const override;
  [[nodiscard]] std::uint64_t revision() const override;

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  [[nodiscard]] BrickStatistics statistics() const;

 private:
  struct Chunk {
    std::uint64_t offset = 0;
    std::vector<std::byte> bytes;
  };
  /// Bytes that were not decoded yet.
  struct Inbox {
    std::vector<std::byte> front, directory;
    std::vector<Chunk> chunks;
    bool finished = false;
    std::uint64_t bytes = 0;
  };
  BrickVolume(StreamHeader header, const BrickLimits& limits, std::shared_ptr<const ChunkSource> source,
              std::uint32_t step);
  [[nodiscard]] bool is_due() const;
  void work(Inbox inbox, const std::vector<LodView>& views);
  void run(std::unique_lock<std::mutex>& lock, bool beside);
  void bound_inbox(std::unique_lock<std::mutex>& lock);
  void await(std::unique_lock<std::mutex>& lock);

  const StreamHeader header_;
  BrickDecoder decoder_;  // used by one call of work() at a time

  mutable std::mutex mutex_;  // guards all members below
  Inbox inbox_;
  std::vector<LodView> views_;  // one per viewport, the latest last
  bool views_changed_ = false, working_ = false;
  std::shared_ptr<const Volume> shown_;
  std::vector<ChunkRange> wanted_;
  BrickStatistics statistics_;
  std::uint64_t taken_ = 0;     // bytes so far
  std::uint64_t revision_ = 0;  // calls of work() so far
  std::chrono::steady_clock::time_point last_work_{};
  std::future<void> running_;
  std::atomic<bool> stop_{false};
};

}  // namespace gs::qnv
