#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace gs::net {

struct GuardedRange;

/// A file in memory, read-only and private, whose reading never ends the program: where the file has become shorter, or
/// the disk fails, zeros are read instead of a signal (SIGBUS) being got, and `lost` says so. Movable; one owner; any
/// thread. The first one installs a handler of SIGBUS for the whole process; what is not about a mapping of this class
/// is passed on to the handler that was there before. Why: docs/decisions/0009.
class GuardedMapping {
 public:
  GuardedMapping() = default;
  GuardedMapping(GuardedMapping&& other) noexcept;
  GuardedMapping& operator=(GuardedMapping&& other) noexcept;
  GuardedMapping(const GuardedMapping&) = delete;
  GuardedMapping& operator=(const GuardedMapping&) = delete;
  ~GuardedMapping();

  /// The first `size` bytes (more than 0) of an open file, which may be closed afterwards; nothing when the system
  /// cannot.
  [[nodiscard]] static std::optional<GuardedMapping> of(int file, std::size_t size);

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }
  /// The first `size` bytes are not needed soon: they take no memory until they are read again.
  void put_aside(std::size_t size) const;
  /// Whether zeros were read in the place of bytes that are no longer there.
  [[nodiscard]] bool lost() const;

 private:
  void release() noexcept;

  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  GuardedRange* range_ = nullptr;
};

}  // namespace gs::net
