#pragma once

#include "app/insitu/include/ghostspace/insitu.h"

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace gs::app::insitu {

/// Communication of the ranks of a simulation, through the functions of its caller. After a failure, all functions
/// return false at once.
class Ranks {
 public:
  /// Uses a table of functions; nullptr means one process.
  explicit Ranks(const gs_insitu_communicator* table);

  [[nodiscard]] int rank() const { return rank_; }
  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] bool is_first() const { return rank_ == 0; }
  [[nodiscard]] bool failed() const { return failed_; }
  /// Returns the number of bytes that this rank sent.
  [[nodiscard]] std::uint64_t sent() const { return sent_; }

  /// Copies the bytes of rank 0 to all ranks.
  bool broadcast(void* data, std::size_t bytes);
  template <class T>
  bool broadcast(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    return broadcast(&value, sizeof value);
  }
  /// Copies the bytes of each rank to rank 0, in the order of the ranks. Only rank 0 uses `all`.
  bool gather(const void* data, std::size_t bytes, void* all);
  /// Sends bytes to rank 0.
  bool send(const void* data, std::size_t bytes);
  /// Receives bytes on rank 0.
  bool receive(void* data, std::size_t bytes, int from);

 private:
  bool note(int result);

  gs_insitu_communicator table_{};
  int rank_ = 0, count_ = 1;
  bool failed_ = false;
  std::uint64_t sent_ = 0;
};

/// Returns an error if a table of functions is incomplete, or nullptr.
[[nodiscard]] const char* check_communicator(const gs_insitu_communicator& table);

}  // namespace gs::app::insitu
