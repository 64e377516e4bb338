#pragma once

#include "base/array.h"
#include "base/budget.h"
#include "base/diagnostic.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

namespace gs::app {

/// Invalid index. Marks a wrong index from the file until its face is removed.
inline constexpr std::int32_t kBadIndex = std::numeric_limits<std::int32_t>::max();
/// End marker of a face or line in an index array (VRML97 6.23).
inline constexpr std::int32_t kFaceEnd = -1;

/// Exception for an importer that exceeds its memory budget or time limit. The readers of assets catch it.
class OutOfBudget : public std::exception {};

/// Diagnostics and memory of one import.
class ImportContext {
 public:
  /// `file` is the name in diagnostics; `diagnostics` must outlive this object.
  ImportContext(std::string file, const WorldBudget& budget, Diagnostics& diagnostics)
      : file_(std::move(file)), budget_(budget), memory_(budget, Resource::nodes), diagnostics_(diagnostics) {}

  [[nodiscard]] const WorldBudget& budget() const { return budget_; }
  /// Charges memory of the content or of the import to the budget. Throws OutOfBudget.
  void draw(std::uint64_t bytes) {
    if (!memory_.grow(bytes) || budget_->stopped()) throw OutOfBudget();
  }

  void report(Severity severity, std::string message, SourceLocation location = {}) {
    diagnostics_.add({severity, file_, location, std::move(message)});
  }
  void note(std::string message, SourceLocation at = {}) { report(Severity::note, std::move(message), at); }
  void warn(std::string message, SourceLocation at = {}) { report(Severity::warning, std::move(message), at); }
  void fail(std::string message, SourceLocation at = {}) { report(Severity::error, std::move(message), at); }

 protected:
  [[nodiscard]] Share& memory() { return memory_; }

 private:
  std::string file_;
  WorldBudget budget_;
  Share memory_;
  Diagnostics& diagnostics_;
};

/// Fast builder of an Array, without checks for each value. `take` returns the result. Throws OutOfBudget.
template <class T>
requires std::is_trivially_copyable_v<T>
class Appender {
 public:
  /// Charges the memory of the array to `context`, which must outlive it.
  explicit Appender(ImportContext& context) : context_(&context) {}

  void push(const T& value) {
    if (next_ == end_) grow();
    *next_++ = value;
  }
  [[nodiscard]] std::size_t size() const { return array_.size() + static_cast<std::size_t>(next_ - first_); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  /// Removes the last `count` values.
  void drop(std::size_t count) {
    flush();
    array_.resize(array_.size() - count);
    first_ = next_ = end_ = nullptr;
  }
  /// Appends copies of `value` until there are `size` values.
  void fill(std::size_t size, const T& value) {
    while (this->size() < size) push(value);
  }
  [[nodiscard]] Array<T> take() {
    flush();
    array_.shrink_to_fit();
    first_ = next_ = end_ = nullptr;
    return std::exchange(array_, {});
  }

 private:
  void flush() {
    array_.commit(static_cast<std::size_t>(next_ - first_));
    first_ = next_;
  }
  void grow() {
    flush();
    constexpr std::size_t kFirst = 256, kMax = std::size_t{1} << 18;  // values between two budget checks
    const std::size_t more = std::clamp(array_.size(), kFirst, kMax);
    context_->draw(more * sizeof(T));
    first_ = next_ = array_.prepare(more);
    end_ = next_ + more;
  }

  ImportContext* context_;
  Array<T> array_;
  T* first_ = nullptr;  // start of the values that array_ does not count yet
  T* next_ = nullptr;
  T* end_ = nullptr;
};

}  // namespace gs::app
