#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace gs::qnv {

/// Leaves what a vector grows by as memory has it, for what is written anyway before it is read. Large vectors lie in
/// large pages where the system has them: of small ones each costs more when it is first written than what is written.
template <class T>
struct RawAllocator : std::allocator<T> {
  static_assert(std::is_trivially_destructible_v<T>);
  template <class U>
  struct rebind {
    using other = RawAllocator<U>;
  };
  [[nodiscard]] T* allocate(std::size_t count) {
    if (count < kLarge / sizeof(T)) return std::allocator<T>().allocate(count);
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(T)) throw std::bad_array_new_length();
    void* const memory = ::operator new(count * sizeof(T), kLargePage);
#if defined(__linux__)
    (void)::madvise(memory, count * sizeof(T), MADV_HUGEPAGE);  // a hint
#endif
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    if (count < kLarge / sizeof(T))
      std::allocator<T>().deallocate(memory, count);
    else
      ::operator delete(memory, kLargePage);
  }
  template <class U>
  void construct(U* at) noexcept(std::is_nothrow_default_constructible_v<U>) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... Arguments>
  void construct(U* at, Arguments&&... arguments) {
    ::new (static_cast<void*>(at)) U(std::forward<Arguments>(arguments)...);
  }

 private:
  static constexpr std::size_t kLarge = std::size_t{4} << 20;  // bytes
  static constexpr std::align_val_t kLargePage{std::size_t{2} << 20};
};

template <class T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace gs::qnv
