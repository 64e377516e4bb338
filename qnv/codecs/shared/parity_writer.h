#pragma once

#include "qnv/codecs/shared/outgoing_chunk.h"
#include "qnv/container/lost_chunks.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <unordered_map>
#include <vector>

namespace gs::qnv {

/// Protection of a stream against lost chunks.
struct Protection {
  enum class Kind : std::uint8_t {
    none,
    unequal,  // the chunks with the largest gains only, in about kUnequalShare of the bytes
    equal     // all chunks
  };
  Kind kind = Kind::none;
  double loss = 0;  // equal: share of lost chunks that parity restores with high probability, 0 to kMostLoss
};
inline constexpr double kUnequalShare = 0.03, kMostLoss = 0.5;

/// Returns the number of parity chunks for a group: with them, a group fails once in a thousand times at this loss.
[[nodiscard]] std::size_t parity_for(std::size_t members, double loss);
/// Returns the estimated bytes of parity per byte of chunks in a long stream.
[[nodiscard]] double parity_share(const Protection& protection);

/// Makes the parity chunks of a stream while its chunks are written. Each group has consecutive chunks; the first
/// groups are small. Parity follows its group, and with Protection::Kind::unequal also later, at most kParityReach
/// after the start of the group. So every prefix is protected. Memory is bounded by kParityReach.
class ParityWriter {
 public:
  explicit ParityWriter(Protection protection) : protection_(protection) {}

  /// Takes the next chunk of the stream. Returns the payloads of the parity chunks to be written after it.
  [[nodiscard]] std::vector<std::vector<std::byte>> add(const OutgoingChunk& chunk);
  /// Ends the stream. Returns the payloads of the last parity chunks.
  [[nodiscard]] std::vector<std::vector<std::byte>> finish();

 private:
  struct Group {
    std::vector<ParityMember> members;
    std::size_t sent = 0;     // parity chunks
    std::size_t bytes = 0;    // of a parity chunk
    std::uint64_t start = 0;  // offset of the first member, from the first chunk
    double gain = 0;          // of the members and of the chunks that depend on them
    // Most useful number of further parity chunks, and their reduction of the lost share of `gain` per byte.
    std::size_t next = 0;
    double use = 0;
  };
  void close_group(std::vector<std::vector<std::byte>>& out);
  void protect_best(double slope, std::vector<std::vector<std::byte>>& out);
  void send(Group& group, std::size_t count, std::vector<std::vector<std::byte>>& out);
  void find_use(Group& group) const;

  Protection protection_;
  std::deque<Group> groups_;  // within reach
  std::uint64_t first_ = 0;   // number of groups_.front()
  Group open_;
  double open_gain_ = 0;
  std::uint64_t open_bytes_ = 0;
  std::vector<std::uint32_t> open_chains_;
  std::unordered_map<std::uint32_t, std::vector<std::uint64_t>> chains_;  // groups with chunks of a chain
  std::uint64_t offset_ = 0, parity_ = 0;                                 // bytes so far; of these, parity
};

}  // namespace gs::qnv
