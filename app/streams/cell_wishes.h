#pragma once

#include "app/streams/stream_feed.h"
#include "net/cells/cell_contract.h"
#include "net/cells/cell_source.h"
#include "qnv/codecs/values/chunk_places.h"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

// Chunks of long values as cells. Stream kPlacesStream has the directory of the file, which clients request
// like other chunks. The chunks that it lists have the numbers of their order in the file.
constexpr std::uint8_t kPlacesStream = 1;
constexpr std::size_t kMaxNumbered = std::size_t{4} * net::kMaxChunks;

/// Returns the name of a chunk by its number. Streams of other than values have fewer than kMaxChunks.
[[nodiscard]] net::ChunkName cell_of_number(std::size_t number);
/// Returns the number of a chunk that is not of the directory.
[[nodiscard]] std::size_t number_of_cell(const net::ChunkName& name);
/// Returns the numbered chunks of each stream, with the directory in `places` chunks.
[[nodiscard]] std::vector<std::uint32_t> cells_of_numbers(std::size_t numbers, std::size_t places);

/// Chunks that views request of a long stream of cells: first its directory and the first chunks, then the chunks that
/// views want. Lost chunks are requested until they arrive. Reader thread only.
class CellWishes {
 public:
  /// `base` are the first bytes of the stream, and `places` the number of chunks of the directory.
  CellWishes(std::shared_ptr<StreamFeed> feed, std::span<const std::byte> base, std::uint32_t places);

  /// Reports whether views can choose the chunks of a stream: those of large volumes and of time series. `base` are its
  /// first bytes.
  [[nodiscard]] static bool suits(const StreamFeed& feed, std::span<const std::byte> base);

  /// Takes a received chunk, and passes it to a feed that takes bytes. Returns an error if it makes the directory
  /// unusable, else an empty string.
  [[nodiscard]] std::string take(const net::ChunkName& name, std::vector<std::byte> chunk);
  /// Follows what views want. Returns true if the names changed.
  bool update();
  /// Returns the chunks to request, most important first.
  [[nodiscard]] const std::vector<net::ChunkName>& names() const { return names_; }
  /// Returns those that were received before, and are wanted again since the last call.
  [[nodiscard]] std::vector<net::ChunkName> take_again() { return std::exchange(again_, {}); }
  /// Reports whether nothing is awaited. Nothing counts as awaited if the server has sent nothing for long.
  [[nodiscard]] bool rests() const;
  /// Reports whether all chunks were received.
  [[nodiscard]] bool complete() const { return has_all_places() && first_ + received_ >= offsets_.size(); }

 private:
  using Clock = std::chrono::steady_clock;
  [[nodiscard]] std::string read_places();
  [[nodiscard]] bool read_part(std::span<const std::byte> chunk);
  void note(std::size_t number);
  void pass(std::size_t number, std::vector<std::byte> chunk);
  void pass_early();
  [[nodiscard]] bool has_all_places() const { return next_place_ == places_.size(); }
  void name_first();
  void name_wanted();

  std::shared_ptr<StreamFeed> feed_;
  bool general_ = false;                                 // the directory may be a general one
  std::size_t first_ = 0;                                // chunks in the base
  std::vector<std::vector<std::byte>> places_;           // chunks of the directory; empty if not received
  std::size_t next_place_ = 0;                           // those before it were read
  qnv::values::PlacesReader reader_;                     // until the directory is complete
  std::vector<std::uint64_t> offsets_;                   // of the chunks in the directory, ascending
  std::size_t received_ = 0, open_ = 0;                  // different chunks received; names that are awaited, or fewer
  bool cut_ = false;                                     // more is wanted than there are names
  std::vector<bool> taken_;                              // by number
  std::map<std::size_t, std::vector<std::byte>> early_;  // chunks with unknown offsets, by number
  std::size_t early_bytes_ = 0;
  std::vector<qnv::ChunkRange> wanted_;
  std::vector<net::ChunkName> names_, again_;
  std::vector<bool> asked_again_;  // by number, since the last change of `wanted_`
  bool changed_ = true;
  Clock::time_point latest_ = Clock::now();  // of received chunks and new names
};

}  // namespace gs::app
