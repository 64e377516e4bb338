#pragma once

#include "base/box.h"
#include "qnv/codecs/shared/chunk_requests.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Requests for the chunks of a stream that is decoded completely, ordered by its directory: first the chunks in any
/// view, then the others, both in the order of the stream. Codecs with RequestOrder::stream cannot profit from views
/// and keep the order of the stream: each layer of records and of voxels spreads over the whole object, and the
/// segments of a progressive mesh need their predecessors. Without views, all codecs keep it. For values of a volume,
/// chunks that are finer than the pixels of all views also come last; short streams keep their order. Of time series,
/// the chunks that the shown steps need come first, then those of the next steps. A picture of one step
/// requests only the chunks of that step and of earlier steps in its chain. Any thread.
class DirectoryRequests final : public ChunkRequests {
 public:
  /// `only_step` is the step of a time series to request without the others; nullopt means all.
  explicit DirectoryRequests(const StreamHeader& header, std::optional<std::uint32_t> only_step = std::nullopt);

  bool set_directory(std::span<const std::byte> chunks) override;
  void note(const LodView& view) override;
  void forget(std::uint32_t viewport) override;
  [[nodiscard]] std::vector<LodView> views() const override;
  [[nodiscard]] const Box& box() const override { return header_.description.box; }
  [[nodiscard]] std::uint64_t directory() const override { return header_.directory; }
  [[nodiscard]] bool in_stream_order() const override { return !by_view_ && !only_step_; }
  [[nodiscard]] std::vector<ChunkRange> wanted() const override;

 private:
  static constexpr std::size_t kViews = 16;

  struct Viewed {
    LodView view;
    bool backwards = false;  // plays a time series backwards
  };
  [[nodiscard]] bool is_first(const DirectoryEntry& entry, const LodView& view) const;
  [[nodiscard]] std::vector<ChunkRange> of_one_step() const;

  const StreamHeader header_;  // without the base mesh
  const bool by_view_;         // the codec profits from views
  const std::optional<std::uint32_t> only_step_;
  mutable std::mutex mutex_;  // guards all members below
  std::vector<DirectoryEntry> entries_;
  std::vector<Viewed> views_;  // one per viewport, the latest last
};

}  // namespace gs::qnv
