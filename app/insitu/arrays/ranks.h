#pragma once

#include "app/insitu/include/ghostspace/insitu.h"

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <type_traits>
#include <utility>
#include <vector>

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

  /// Returns the seconds in which functions of the caller blocked without using the processor.
  [[nodiscard]] double blocked() const { return blocked_; }

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
  /// Sets `all` to true if `own` is true on all ranks. Collective.
  bool agree(bool own, bool& all);

  /// Does local work between collective functions. Returns false if the work threw an exception. So this rank still
  /// reaches the next collective function, for which the others wait. `part` names the work for set_fault().
  template <class Work>
  [[nodiscard]] bool attempt(const char* part, const Work& work) noexcept {
    try {
      if (fault_) fault_(part);
      work();
      return true;
    } catch (const std::exception&) {
      return false;
    }
  }
  /// Sets a function that attempt() calls before its work, and that may throw. For tests.
  void set_fault(std::function<void(const char* part)> fault) { fault_ = std::move(fault); }

 private:
  template <class Call>
  bool run(const Call& call);

  gs_insitu_communicator table_{};
  int rank_ = 0, count_ = 1;
  bool failed_ = false;
  double blocked_ = 0;
  std::vector<std::uint32_t> agreed_;  // answers of all ranks in agree(), on rank 0
  std::function<void(const char* part)> fault_;
  std::uint64_t sent_ = 0;
};

/// Returns an error if a table of functions is incomplete, or nullptr.
[[nodiscard]] const char* check_communicator(const gs_insitu_communicator& table);

}  // namespace gs::app::insitu
