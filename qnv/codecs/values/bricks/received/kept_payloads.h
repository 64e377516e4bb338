#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <unordered_set>
#include <vector>

namespace gs::qnv::values {

/// Payloads of received chunks, by the offsets of the chunks. Drops payloads beyond a limit; they can be received
/// again. One thread at a time.
class KeptPayloads : NonCopyable {
 public:
  explicit KeptPayloads(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  /// Keeps a payload for `owner`, a number that trim() passes to `used`.
  void keep(std::uint64_t offset, std::uint64_t owner, std::span<const std::byte> payload);
  /// Drops payloads for which `used`(owner) is false, from the end of the stream, until the limit is met.
  void trim(const std::function<bool(std::uint64_t owner)>& used);

  /// Returns a payload, or null. Any thread, while no other thread changes this.
  [[nodiscard]] const std::vector<std::byte>* find(std::uint64_t offset) const;
  [[nodiscard]] bool has(std::uint64_t offset) const { return kept_.contains(offset); }
  /// Reports whether the chunk was received and dropped.
  [[nodiscard]] bool was_dropped(std::uint64_t offset) const { return dropped_.contains(offset); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::uint64_t owner = 0;
    std::vector<std::byte> payload;
  };
  std::size_t most_bytes_, bytes_ = 0;
  std::map<std::uint64_t, Kept> kept_;
  std::unordered_set<std::uint64_t> dropped_;
};

}  // namespace gs::qnv::values
