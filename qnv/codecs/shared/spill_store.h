#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
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
