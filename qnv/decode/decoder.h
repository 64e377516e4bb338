#pragma once

#include "qnv/displaced/surface.h"
#include "qnv/packed/packed.h"
#include "qnv/records/records_assembly.h"
#include "qnv/stream/container.h"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace gs::qnv {

/// Turns a stream that arrives piece by piece, or with holes, into vectors. What has arrived is always a whole
/// picture. One thread; safe for untrusted bytes; memory is bounded by `most_vectors`.
class StreamDecoder {
 public:
  explicit StreamDecoder(std::size_t most_vectors = std::size_t{1} << 26) : most_vectors_(most_vectors) {}

  /// The next bytes of the stream. False once it was refused.
  bool push(std::span<const std::byte> bytes);
  /// A chunk that came by another way (a datagram), after the header. Any order, any subset. Of a chunk of records the
  /// bytes `missing` from the payload, and those behind its end, may come another time, or never; other chunks are
  /// refused then.
  void add(ChunkType type, std::span<const std::byte> payload, std::span<const ByteRange> missing = {});
  /// The stream has ended: reads what waited for more bytes, and says what is missing.
  void finish();

  [[nodiscard]] const StreamHeader* header() const { return reader_.header(); }
  [[nodiscard]] const std::vector<StreamProblem>& problems() const { return reader_.problems(); }
  [[nodiscard]] std::size_t refused_chunks() const { return refused_chunks_; }
  /// Whether chunks were left out because of `most_vectors`.
  [[nodiscard]] bool full() const { return full_; }
  /// How many discs `cloud` has.
  [[nodiscard]] std::size_t vectors() const { return vectors_; }
  /// Changes whenever `cloud` would.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  [[nodiscard]] const std::vector<DirectoryEntry>& directory() const { return directory_; }

  /// Everything that has arrived, each place at its finest; discs that were refined are gone.
  [[nodiscard]] Cloud cloud() const;

 private:
  /// Bytes that a chunk without its parent takes, about.
  static std::size_t cost(std::span<const std::byte> payload) { return payload.size() + 128; }
  struct Held {
    Cluster cluster;
    std::vector<bool> refined;  // a voxel: its children have arrived
  };
  void add_packed(std::span<const std::byte> payload);
  void begin_surface();
  void add_stage(int number, displaced::StageHeader stage);
  [[nodiscard]] static int shown_level(const displaced::Surface& surface);
  void add_displaced(std::span<const std::byte> payload);
  /// The last stage of which enough has come to take the place of those before; null: none.
  [[nodiscard]] const displaced::Surface* stage() const;
  void append_surface(const displaced::Surface& surface, Cloud& cloud) const;
  void count_surface();
  void add_records(std::span<const std::byte> payload, std::span<const ByteRange> missing);
  void append_records(Cloud& cloud) const;
  void take(Cluster cluster);

  StreamReader reader_;
  std::size_t most_vectors_, vectors_ = 0, refused_chunks_ = 0, waiting_bytes_ = 0;
  std::uint64_t revision_ = 0;
  std::size_t voxels_ = 0;  // of all clusters, also where discs were refined
  bool full_ = false;
  bool begun_ = false;   // displaced: the first stage was read
  bool rooted_ = false;  // the cluster without a parent has arrived
  std::map<std::uint32_t, Held> clusters_;
  std::multimap<std::uint32_t, std::vector<std::byte>> orphans_;  // by the parent that has not arrived
  std::map<int, displaced::Surface> stages_;
  std::multimap<int, std::vector<std::byte>> waiting_;  // clusters of stages whose base has not come
  mutable std::optional<RecordsAssembly> records_;      // files what arrived only when it is asked
  std::vector<DirectoryEntry> directory_;
};

}  // namespace gs::qnv
