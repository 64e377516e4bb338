#pragma once

#include "qnv/lod/lod_cache.h"
#include "qnv/lod/lod_source.h"
#include "qnv/lod/lod_tree.h"
#include "qnv/packed/packed.h"
#include "qnv/stream/container.h"

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::qnv {

/// Some discs of a cloud.
struct Piece {
  std::shared_ptr<const Cloud> cloud;
  std::size_t first = 0, count = 0;
  std::uint8_t level = 0;   // of the octree
  std::uint32_t chunk = 0;  // a number of its own
  float age = 0;            // 0: came first, 1: last
};

/// From where, and how closely, a stream is looked at. Node space: the units of the stream.
struct LodView {
  glm::vec3 eye{0};
  float pixels = 1000;                // of one unit at distance one
  std::array<glm::vec4, 5> planes{};  // inside of the view: dot(plane, (p, 1)) >= 0; all zero: everything is
  std::size_t budget = 0;             // discs at most; 0: no limit
  float error_pixels = 1;             // voxels need not be smaller than this on the screen
  std::uint32_t viewport = 0;         // which of those that look by turns; each keeps the detail that it had
  std::size_t most_decoded = 0;       // discs that may be decoded now; 0: as many as are needed
  bool leave_backs = false;           // of a stream that is not two-sided, leave out what faces away from the eye
  bool each_chunk = false;            // no piece holds discs of two chunks
  friend bool operator==(const LodView&, const LodView&) = default;
};

/// Where a chunk stands in its stream.
struct ChunkRange {
  std::uint64_t offset = 0, bytes = 0;
  friend bool operator==(const ChunkRange&, const ChunkRange&) = default;
};

/// What a stream may take.
struct LodLimits {
  std::size_t cache_bytes = std::size_t{1} << 29;    // of what is decoded, beside the last cuts
  std::size_t discs = std::size_t{1} << 26;          // of one cut, or of all that is copied, whatever its budget
  std::size_t arrived_bytes = std::size_t{1} << 30;  // of one that grows: chunks that have come
};

/// A packed stream of which a view decodes what it needs: the coarse clusters everywhere, finer ones where they are
/// seen, the largest on the screen first. The stream lies in memory or in a file, or it grows. One thread; safe for
/// untrusted bytes: what is wrong is left out, with all that is below it, and the coarser picture stays in its place.
class LodStream {
 public:
  /// How much of what is decoded is kept beside the last cuts.
  static constexpr std::size_t kCacheBytes = LodLimits{}.cache_bytes;
  using Opened = std::variant<std::unique_ptr<LodStream>, StreamProblem>;

  /// A stream that lies in memory as it came: all of it is read and checked now. The error says why it cannot be
  /// read so.
  [[nodiscard]] static Opened open(std::vector<std::byte> bytes, std::size_t cache_bytes = kCacheBytes);
  /// A stream that lies elsewhere: its header and its directory are read now, its chunks when a view needs them. Where
  /// the directory is not whole, or does not fit the chunks, all of the stream is read once.
  [[nodiscard]] static Opened open(std::shared_ptr<const ChunkSource> source, std::size_t cache_bytes = kCacheBytes);
  /// A stream of which the first bytes have come, its header at least.
  [[nodiscard]] static Opened begin(std::span<const std::byte> front, std::size_t cache_bytes = kCacheBytes);

  /// Before the first cut.
  void set_limits(const LodLimits& limits);

  /// For one that grows. The bytes behind those that `begin` and the last `push` got. False once there is no sense
  /// in more.
  bool push(std::span<const std::byte> bytes);
  /// There is nothing more to `push`.
  void finish();
  /// All of its directory chunks, one after the other: what `wanted` needs to know. False when they are not whole.
  bool set_directory(std::span<const std::byte> chunks);
  /// A whole chunk that stands at an offset of the stream, in any order. False when it is left out; a problem says why.
  bool add(std::uint64_t offset, std::span<const std::byte> chunk);

  /// What to draw: covers everything in view once, without holes and without overlap. Clusters wholly outside of the
  /// view are left out. For the same view of the same bytes no place has less detail than the last time.
  [[nodiscard]] std::vector<Piece> cut(const LodView& view);
  /// Of the last cut: something that belongs to it is here, but was not decoded yet. The next one is better.
  [[nodiscard]] bool pending() const { return pending_; }
  /// Of the last cut: chunks that belong to it and have not come, most wanted first.
  [[nodiscard]] const std::vector<ChunkRange>& wanted() const { return wanted_; }
  /// The same of the last cuts of all viewports, by turns; each chunk once.
  [[nodiscard]] std::vector<ChunkRange> wanted_by_all() const;
  /// From where the viewports looked the last time.
  [[nodiscard]] std::vector<LodView> views() const;
  /// The last cut was all that the view asked for.
  [[nodiscard]] bool complete() const { return !pending_ && wanted_.empty(); }
  /// A viewport that will not look again.
  void forget(std::uint32_t viewport);

  /// All vectors at full detail, copied together; no more than a cut may have.
  [[nodiscard]] Cloud whole();
  /// Whether `whole` had to leave some places coarse, because there are too many vectors.
  [[nodiscard]] bool cut_short() const { return cut_short_; }
  /// How many there are at full detail. Decodes all of the stream.
  [[nodiscard]] std::size_t count();

  [[nodiscard]] const StreamHeader& header() const { return header_; }
  /// What was wrong with the bytes that were read so far; the stream is what is left.
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return problems_; }
  /// That have come.
  [[nodiscard]] std::size_t clusters() const { return tree_.present(); }
  /// Changes with every chunk that comes.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  [[nodiscard]] std::size_t cached_discs() const { return cache_.disc_count(); }
  [[nodiscard]] std::size_t cached_bytes() const { return cache_.bytes(); }
  /// Discs that were decoded for the last cut, about.
  [[nodiscard]] std::size_t decoded() const { return decoded_; }

 private:
  /// The last cut of one of those that look by turns.
  struct Viewport {
    LodView view;
    std::uint64_t last_cut = 0;  // 0: none yet
    std::uint64_t revision = 0;
    std::vector<std::uint32_t> chosen, shown;
    std::vector<std::uint32_t> lacking;  // nodes that belong to it and have not come, most wanted first
  };
  static constexpr std::size_t kViewports = 16;
  /// Discs of a node that are drawn: voxels `first` to `last`.
  struct Run {
    std::uint32_t node = 0, first = 0, last = 0;
  };

  LodStream(StreamHeader header, std::size_t cache_bytes, bool grows)
      : header_(std::move(header)), cache_(tree_, header_, cache_bytes, grows) {}
  static Opened make(StreamHeader header, std::size_t cache_bytes, bool grows);
  void scan();
  bool directory_fits() const;
  bool take(ChunkType type, std::span<const std::byte> payload, std::uint64_t offset);
  void problem(std::uint64_t offset, std::string message);
  void keep_few_problems();
  /// Voxels first to first + count of a cluster that nothing finer takes the place of.
  using OnVoxels = std::function<void(const Cluster& cluster, std::size_t first, std::size_t count)>;
  /// Goes through all that is there, no finer than so many discs allow; how many they were.
  std::size_t visit_whole(std::size_t most_discs, const OnVoxels& visit);
  void visit_below(std::uint32_t node, const Cluster& cluster, std::size_t most_discs, std::size_t& discs,
                   const OnVoxels& visit);

  std::size_t viewport_of(std::uint32_t id);
  void forget_slot(std::size_t slot);
  void select(const LodView& view, const Viewport& last, std::uint16_t bit);
  [[nodiscard]] std::vector<std::uint32_t> to_decode(const LodView& view);
  [[nodiscard]] std::int64_t discs_gained(std::uint32_t node) const;
  void choose(const LodView& view, Viewport& viewport, std::uint16_t bit);
  [[nodiscard]] std::vector<Run> runs(Viewport& viewport, std::uint16_t bit) const;
  [[nodiscard]] std::vector<Piece> pieces(const LodView& view, std::span<const Run> runs) const;

  std::size_t most_discs_ = LodLimits{}.discs;
  bool cut_short_ = false;
  StreamHeader header_;
  std::shared_ptr<const ChunkSource> source_;
  std::shared_ptr<ArrivedChunks> arrived_;  // the same, of a stream that grows
  StreamReader reader_;                     // of what is pushed
  std::size_t reader_problems_ = 0;         // of those that were taken over
  LodTree tree_;
  LodCache cache_;
  std::vector<StreamProblem> problems_;
  std::uint64_t revision_ = 1, cuts_ = 0;
  std::array<Viewport, kViewports> viewports_;

  // Of the cut in work, and then of the last one.
  std::vector<std::uint32_t> order_;  // what the view asks for, most important first
  std::vector<ChunkRange> wanted_;
  std::size_t decoded_ = 0;
  bool pending_ = false;
};

}  // namespace gs::qnv
