#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace gs::net {

struct GuardedRange;

/// Private, read-only mapping of a file. Reading it never ends the program. If the file became shorter or the disk
/// fails, missing bytes read as zeros instead of raising SIGBUS, and `lost` returns true. Movable. One owner. Any
/// thread.
///
/// The first mapping installs a handler of SIGBUS for the process. The handler passes other faults to the previous
/// handler. Reason: docs/decisions/0009.
class GuardedMapping {
 public:
  GuardedMapping() = default;
  GuardedMapping(GuardedMapping&& other) noexcept;
  GuardedMapping& operator=(GuardedMapping&& other) noexcept;
  GuardedMapping(const GuardedMapping&) = delete;
  GuardedMapping& operator=(const GuardedMapping&) = delete;
  ~GuardedMapping();

  /// Maps the first `size` bytes (more than 0) of an open file. The caller may close the file afterwards. Returns
  /// nullopt if the system cannot map the file.
  [[nodiscard]] static std::optional<GuardedMapping> of(int file, std::size_t size);

  [[nodiscard]] std::span<const std::byte> bytes() const { return {data_, size_}; }
  /// Releases the memory of the first `size` bytes. The next access reads them again.
  void put_aside(std::size_t size) const;
  /// Reports whether zeros replaced missing bytes.
  [[nodiscard]] bool lost() const;

 private:
  void release() noexcept;

  const std::byte* data_ = nullptr;
  std::size_t size_ = 0;
  GuardedRange* range_ = nullptr;
};

}  // namespace gs::net
