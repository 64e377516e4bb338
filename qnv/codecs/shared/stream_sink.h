#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gs::qnv {

/// Output of an encoder. The functions return false to stop the encoder.
class StreamSink {
 public:
  virtual ~StreamSink() = default;

  /// Takes the next bytes.
  virtual bool write(std::span<const std::byte> bytes) = 0;
  /// Replaces bytes at the start, all of which were written before.
  virtual bool rewrite_front(std::span<const std::byte> bytes) = 0;
  /// Reports whether this process writes the next bytes. If not, the encoder may call skip() instead of write().
  [[nodiscard]] virtual bool wants() const { return true; }
  /// Skips the next bytes, because another process writes them. Returns false if the sink needs all bytes.
  virtual bool skip(std::uint64_t /*bytes*/) { return false; }
};

/// Output in memory.
class MemorySink final : public StreamSink {
 public:
  explicit MemorySink(std::vector<std::byte>& bytes) : bytes_(bytes) {}
  bool write(std::span<const std::byte> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return true;
  }
  bool rewrite_front(std::span<const std::byte> bytes) override {
    std::ranges::copy(bytes, bytes_.begin());
    return true;
  }

 private:
  std::vector<std::byte>& bytes_;
};

}  // namespace gs::qnv
