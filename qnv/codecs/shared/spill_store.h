#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gs::qnv {

/// Store of bytes that an encoder writes in order and reads at any offset. It may be a file, so that the bytes may
/// exceed memory. One thread writes; then several may read.
class SpillStore {
 public:
  virtual ~SpillStore() = default;

  /// Adds bytes at the end. Returns false if they cannot be stored; problem() has the reason.
  [[nodiscard]] virtual bool append(std::span<const std::byte> bytes) = 0;
  /// Returns the number of bytes.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
  /// Copies bytes from `offset` on. Returns false if there are fewer, or if they cannot be read.
  [[nodiscard]] virtual bool read(std::uint64_t offset, std::span<std::byte> to) const = 0;
  [[nodiscard]] virtual std::string problem() const { return "not enough memory"; }

  // Stores that several processes share, and that outlive the processes, override the following functions. Their
  // offsets are valid in all processes, and size() is the offset of the next byte that this process appends.

  /// Makes all bytes appended so far readable for other processes. Returns false on failure.
  [[nodiscard]] virtual bool publish() { return true; }
  /// Returns the result that a process recorded for this work with finish(), also in an earlier run. Returns nullopt if
  /// there is none, or if its bytes are damaged.
  [[nodiscard]] virtual std::optional<std::vector<std::byte>> finished(std::string_view /*work*/) const {
    return std::nullopt;
  }
  /// Records the result of work that appended the bytes from offset `first` on. Returns false on failure.
  [[nodiscard]] virtual bool finish(std::string_view /*work*/, std::uint64_t /*first*/,
                                    std::span<const std::byte> /*result*/) {
    return true;
  }
};

/// Store in memory, in pieces.
class MemoryStore final : public SpillStore {
 public:
  [[nodiscard]] bool append(std::span<const std::byte> bytes) override;
  [[nodiscard]] std::uint64_t size() const override { return size_; }
  [[nodiscard]] bool read(std::uint64_t offset, std::span<std::byte> to) const override;

 private:
  std::vector<std::vector<std::byte>> pieces_;
  std::uint64_t size_ = 0;
};

}  // namespace gs::qnv
