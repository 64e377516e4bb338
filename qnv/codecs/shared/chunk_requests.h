#pragma once

#include "base/box.h"
#include "qnv/codecs/shared/lod_view.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Position of a chunk in its stream.
struct ChunkRange {
  std::uint64_t offset = 0, bytes = 0;
  bool again = false;  // the chunk was received and dropped
  friend bool operator==(const ChunkRange&, const ChunkRange&) = default;
};

/// Requests of views for the chunks of one stream. Every codec has an implementation: LodStream requests the clusters
/// that its cuts lack, DirectoryRequests serves the other codecs. One thread at a time.
class ChunkRequests {
 public:
  ChunkRequests() = default;
  ChunkRequests(const ChunkRequests&) = delete;
  ChunkRequests& operator=(const ChunkRequests&) = delete;
  virtual ~ChunkRequests() = default;

  /// Sets the directory. `chunks` are all directory chunks, concatenated. wanted() needs the directory. Returns false
  /// if `chunks` is incomplete.
  virtual bool set_directory(std::span<const std::byte> chunks) = 0;
  /// Notes the view with which a viewport draws the geometry of the stream. A cut does this by itself.
  virtual void note(const LodView& view) = 0;
  /// Forgets a viewport that no longer draws the geometry.
  virtual void forget(std::uint32_t viewport) = 0;
  /// Returns the last view of each viewport.
  [[nodiscard]] virtual std::vector<LodView> views() const = 0;
  /// Returns the bounds of the stream, in the coordinates of the views.
  [[nodiscard]] virtual const Box& box() const = 0;
  /// Returns the offset of the directory in the stream. 0 means unknown.
  [[nodiscard]] virtual std::uint64_t directory() const = 0;
  /// Reports whether wanted() keeps the order of the stream for every view. If so, reading from front to back is
  /// better.
  [[nodiscard]] virtual bool in_stream_order() const = 0;
  /// Returns the chunks to request for all views, most wanted first.
  [[nodiscard]] virtual std::vector<ChunkRange> wanted() const = 0;
};

}  // namespace gs::qnv
