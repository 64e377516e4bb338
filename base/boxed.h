#pragma once

#include "base/array.h"

namespace gs {

/// Value of one pointer's size, for large values of a variant. Copies share storage until one of them changes.
///
/// A default value is T(kInitial) and owns no memory. The rules of Array for threads apply.
template <class T, int kInitial>
class Boxed {
 public:
  using element_type = T;

  Boxed() = default;
  Boxed(const T& value) { box_.push_back(value); }

  [[nodiscard]] const T& operator*() const { return box_.empty() ? initial() : box_[0]; }
  [[nodiscard]] const T* operator->() const { return &**this; }
  /// Returns the writable value. Copies shared storage first.
  [[nodiscard]] T& edit() {
    if (box_.empty()) box_.push_back(initial());
    return *box_.mutable_data();
  }

  friend bool operator==(const Boxed& a, const Boxed& b) { return a.box_.shares_with(b.box_) || *a == *b; }

 private:
  static const T& initial() {
    static const T value(kInitial);
    return value;
  }

  Array<T> box_;  // empty, or one element
};

}  // namespace gs
