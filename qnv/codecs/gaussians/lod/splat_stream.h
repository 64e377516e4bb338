#pragma once

#include "qnv/codecs/gaussians/lod/splat_cache.h"
#include "qnv/codecs/gaussians/lod/splat_chunks.h"
#include "qnv/codecs/gaussians/lod/splat_cutter.h"
#include "qnv/codecs/shared/lod_view.h"
#include "qnv/codecs/shared/viewed_stream.h"
#include "qnv/container/container.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Memory limits of a stream of Gaussians.
struct SplatLimits {
  std::size_t cache_bytes = std::size_t{5} << 26;    // decoded clusters that the last cuts do not need
  std::size_t cut_bytes = std::size_t{7} << 26;      // Gaussians of one cut, for any budget
  std::size_t cut_splats = 2'500'000;                // maximum Gaussians of one cut
  std::size_t arrived_bytes = std::size_t{1} << 30;  // received chunks of a stream that still grows
};

/// Bytes of a decoded Gaussian in a cut.
[[nodiscard]] std::size_t bytes_of_splat(int degree);

/// Statistics of a stream of Gaussians.
struct SplatStatistics {
  std::size_t clusters = 0;                         // number of received clusters
  std::size_t cached_splats = 0, cached_bytes = 0;  // decoded Gaussians; memory of all decoded data
  std::size_t decoded = 0;  // approximate number of Gaussians that were decoded for the last cut
};

/// Decoder of all received chunks of a stream. Works while another thread draws the stream.
class WholeSplats {
 public:
  WholeSplats(StreamHeader header, std::vector<gaussians::SplatChunks::Received> chunks,
              std::shared_ptr<const ChunkSource> source)
      : header_(std::move(header)), chunks_(std::move(chunks)), source_(std::move(source)) {}

  /// Returns all Gaussians at full detail, or coarser ones if there would be more than `most`. Restores damaged chunks
  /// by parity. Blocks. Any thread.
  [[nodiscard]] Gaussians decode(std::size_t most) const;

 private:
  StreamHeader header_;
  std::vector<gaussians::SplatChunks::Received> chunks_;
  std::shared_ptr<const ChunkSource> source_;
};

/// Stream of Gaussians from which each view decodes the clusters that it needs: coarse ones everywhere, finer ones in
/// view, largest in the picture first. The stream is in memory, in a file, or still growing. One thread at a time. Safe
/// for untrusted bytes: skips invalid clusters with their descendants; the coarser picture remains.
class SplatStream final : public ViewedStream {
 public:
  using Opened = std::variant<std::unique_ptr<SplatStream>, StreamProblem>;

  /// Opens a stream in memory. Reads all chunks now. Returns an error if there are no Gaussians.
  [[nodiscard]] static Opened open(std::span<const std::byte> bytes);
  /// Opens a stream from a source, such as a file. Reads the header and the directory now, and a chunk when a view
  /// needs it. If the directory is incomplete or wrong, reads the whole stream once.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source);
  /// Opens a growing stream from its first bytes, which must contain the whole header.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front);

  /// Sets the limits. Call it before the first cut.
  void set_limits(const SplatLimits& limits);

  bool push(std::span<const std::byte> bytes) override { return chunks_.push(bytes); }
  void finish() override { chunks_.finish(); }
  bool set_directory(std::span<const std::byte> chunks) override { return chunks_.set_directory(chunks); }
  bool add(std::uint64_t offset, std::span<const std::byte> chunk) override { return chunks_.add(offset, chunk); }

  /// Returns the runs of Gaussians to draw. They cover every part of the scene in view exactly once. Omits clusters
  /// outside of the view. Valid until the next call.
  ///
  /// With a `time` (viewport's clock, in seconds), changes since the last cut of the viewport take a quarter of a
  /// second: the opacity of new Gaussians rises while that of the replaced ones falls. Without a time, changes
  /// are immediate, and the call waits for the repair of damaged chunks. With a time, it does not wait. Changes are
  /// also immediate if `fades` is false.
  [[nodiscard]] const std::vector<SplatRun>& cut(const LodView& view, std::optional<double> time = {},
                                                 bool fades = true) {
    return cutter_.cut(view, time, fades);
  }
  /// Reports whether the last cut lacks clusters that are received but not decoded yet. If so, the next cut is better.
  [[nodiscard]] bool pending() const { return cutter_.pending(); }
  /// Reports whether Gaussians of the last cut fade in or out.
  [[nodiscard]] bool fading() const { return cutter_.fading(); }
  /// Reports whether another thread restores damaged chunks. When the thread ends, revision() increases.
  [[nodiscard]] bool repairing() const { return chunks_.repairing(); }

  /// Does nothing, because cut() records its view.
  void note(const LodView&) override {}
  void forget(std::uint32_t viewport) override { cutter_.forget(viewport); }
  [[nodiscard]] std::vector<LodView> views() const override { return cutter_.views(); }
  [[nodiscard]] const Box& box() const override { return header().description.box; }
  [[nodiscard]] std::uint64_t directory() const override { return header().directory; }
  [[nodiscard]] bool in_stream_order() const override { return false; }
  [[nodiscard]] std::vector<ChunkRange> wanted() const override { return cutter_.lacking_for_all(); }

  /// Returns a decoder of all received chunks.
  [[nodiscard]] WholeSplats whole() const { return {header(), chunks_.received(), chunks_.source()}; }
  /// Returns at most `most` Gaussians of the whole stream, without harmonics.
  [[nodiscard]] Gaussians overview(std::size_t most);

  [[nodiscard]] const StreamHeader& header() const { return chunks_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return chunks_.problems(); }
  /// Returns a counter that increases with every received chunk, and when a repair of damaged chunks ends.
  [[nodiscard]] std::uint64_t revision() const { return chunks_.revision() + (chunks_.repaired() ? 1 : 0); }
  [[nodiscard]] SplatStatistics statistics() const {
    return {chunks_.tree().present(), cache_.splats(), cache_.bytes(), cutter_.decoded()};
  }

 private:
  explicit SplatStream(gaussians::SplatChunks chunks)
      : chunks_(std::move(chunks)), cache_(chunks_, SplatLimits{}.cache_bytes), cutter_(chunks_, cache_) {
    set_limits({});
  }
  [[nodiscard]] static Opened make(gaussians::SplatChunks::Opened opened);

  gaussians::SplatChunks chunks_;
  gaussians::SplatCache cache_;
  gaussians::SplatCutter cutter_;
};

}  // namespace gs::qnv
