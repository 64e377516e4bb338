#pragma once

#include "base/noncopyable.h"

#include <cstddef>
#include <memory>
#include <new>
#include <vector>

namespace gs::vrml {

/// Growable sequence of elements that never move. Elements are in blocks of 2^kBits. An index takes two loads; an index
/// into std::deque also takes a division, and its blocks hold only 512 bytes.
template <class T, unsigned kBits = 6>
class StableVector : NonCopyable {
 public:
  StableVector() = default;
  ~StableVector() {
    for (std::size_t i = 0; i < size_; ++i) (*this)[i].~T();
  }

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T& operator[](std::size_t i) { return *at(i); }
  [[nodiscard]] const T& operator[](std::size_t i) const { return *at(i); }
  T& emplace_back() {
    if (size_ == blocks_.size() * kBlock)
      blocks_.push_back(std::unique_ptr<std::byte[], Free>(
          static_cast<std::byte*>(::operator new (kBlock * sizeof(T), std::align_val_t{alignof(T)}))));
    T* const made = new (at(size_)) T();
    ++size_;
    return *made;
  }

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << kBits;
  struct Free {
    void operator()(std::byte* block) const { ::operator delete (block, std::align_val_t{alignof(T)}); }
  };

  [[nodiscard]] T* at(std::size_t i) const {
    return reinterpret_cast<T*>(blocks_[i >> kBits].get() + (i & (kBlock - 1)) * sizeof(T));
  }

  std::vector<std::unique_ptr<std::byte[], Free>> blocks_;
  std::size_t size_ = 0;
};

}  // namespace gs::vrml
