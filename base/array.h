#pragma once

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace gs {

/// Growable array with copy-on-write storage.
///
/// DEF/USE, PROTO instances, events and meshes copy field values often; sharing makes each copy a pointer copy. The
/// reference count is atomic, so threads may own copies of one array. Two threads must not use one object at the same
/// time. Storage of trivially copyable elements grows with realloc, which moves pages instead of bytes for large
/// arrays. An empty array owns no memory. Throws std::bad_alloc if memory is exhausted.
template <class T>
class Array {
 public:
  using value_type = T;

  Array() = default;
  Array(std::initializer_list<T> values) { append(std::span<const T>(values.begin(), values.size())); }
  explicit Array(std::span<const T> values) { append(values); }
  Array(const Array& other) noexcept : block_(other.block_) {
    if (block_) block_->references.fetch_add(1, std::memory_order_relaxed);
  }
  Array(Array&& other) noexcept : block_(std::exchange(other.block_, nullptr)) {}
  Array& operator=(Array other) noexcept {
    std::swap(block_, other.block_);
    return *this;
  }
  ~Array() { release(); }

  [[nodiscard]] std::size_t size() const { return block_ ? block_->size : 0; }
  [[nodiscard]] std::size_t capacity() const { return block_ ? block_->capacity : 0; }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] const T* data() const { return block_ ? elements(block_) : nullptr; }
  [[nodiscard]] const T* begin() const { return data(); }
  [[nodiscard]] const T* end() const { return data() + size(); }
  [[nodiscard]] const T& operator[](std::size_t i) const { return elements(block_)[i]; }
  [[nodiscard]] const T& front() const { return (*this)[0]; }
  [[nodiscard]] const T& back() const { return (*this)[size() - 1]; }
  [[nodiscard]] std::span<const T> span() const { return {data(), size()}; }

  /// Reports whether other arrays use the same storage.
  [[nodiscard]] bool shared() const { return block_ && block_->references.load(std::memory_order_acquire) != 1; }
  /// Reports whether both arrays use the same storage.
  [[nodiscard]] bool shares_with(const Array& other) const { return block_ == other.block_; }

  /// Returns writable elements. Copies shared storage first, so that other arrays do not change. Returns null if empty.
  [[nodiscard]] T* mutable_data() {
    if (!block_) return nullptr;
    own(block_->size);
    return elements(block_);
  }

  void reserve(std::size_t capacity) {
    if (capacity > this->capacity() || shared()) own(capacity < size() ? size() : capacity);
  }
  void push_back(T value) {
    const std::size_t count = size();
    if (count == capacity() || shared()) own(grown(count + 1));
    new (elements(block_) + count) T(std::move(value));
    block_->size = count + 1;
  }
  void append(std::span<const T> values) {
    if (values.empty()) return;
    const std::size_t count = size();
    if (count + values.size() > capacity() || shared()) own(grown(count + values.size()));
    for (std::size_t i = 0; i < values.size(); ++i) new (elements(block_) + count + i) T(values[i]);
    block_->size = count + values.size();
  }
  void resize(std::size_t count) {
    if (count == size()) return;
    if (count == 0) {
      clear();
      return;
    }
    if (count > capacity() || shared()) own(count > size() ? count : size());
    T* first = elements(block_);
    for (std::size_t i = block_->size; i < count; ++i) new (first + i) T();
    for (std::size_t i = count; i < block_->size; ++i) first[i].~T();
    block_->size = count;
  }
  void clear() {
    release();
    block_ = nullptr;
  }
  /// Releases the spare capacity of an unshared array.
  void shrink_to_fit() {
    if (block_ && !shared() && block_->capacity > block_->size) reallocate(block_->size);
  }

  /// Returns memory for at least `count` more elements after the last one. The caller writes there, then calls `commit`
  /// with the number of elements written. Trivially copyable types only.
  [[nodiscard]] T* prepare(std::size_t count) requires std::is_trivially_copyable_v<T> {
    if (size() + count > capacity() || shared()) own(grown(size() + count));
    return block_ ? elements(block_) + block_->size : nullptr;
  }
  void commit(std::size_t count) {
    if (block_) block_->size += count;
  }

  friend bool operator==(const Array& a, const Array& b) {
    if (a.block_ == b.block_) return true;
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (!(a[i] == b[i])) return false;
    return true;
  }

 private:
  struct Block {
    std::atomic<std::size_t> references;
    std::size_t size;
    std::size_t capacity;
  };
  static constexpr std::size_t kHeader = (sizeof(Block) + alignof(T) - 1) / alignof(T) * alignof(T);

  static T* elements(Block* block) { return reinterpret_cast<T*>(reinterpret_cast<std::byte*>(block) + kHeader); }
  static std::size_t bytes(std::size_t capacity) {
    if (capacity > (SIZE_MAX / 2 - kHeader) / sizeof(T)) throw std::bad_alloc();
    return kHeader + capacity * sizeof(T);
  }
  // A copy's capacity grows from its size. If it grew from the source's capacity, copies of copies would grow without
  // limit.
  [[nodiscard]] std::size_t grown(std::size_t least) const {
    const std::size_t doubled = (shared() ? size() : capacity()) * 2;
    return least > doubled ? (least < 4 ? 4 : least) : doubled;
  }
  static Block* allocate(std::size_t capacity) {
    void* memory = std::malloc(bytes(capacity));
    if (!memory) throw std::bad_alloc();
    return new (memory) Block{{1}, 0, capacity};
  }
  /// Makes this array the only owner of its storage, with room for exactly `capacity` elements. `capacity` >= size().
  void own(std::size_t capacity) {
    if (!block_) {
      block_ = allocate(capacity);
      return;
    }
    if (!shared()) {
      if (capacity != block_->capacity) reallocate(capacity > block_->capacity ? capacity : block_->capacity);
      return;
    }
    Block* fresh = allocate(capacity);
    const T* from = elements(block_);
    for (std::size_t i = 0; i < block_->size; ++i) new (elements(fresh) + i) T(from[i]);
    fresh->size = block_->size;
    release();
    block_ = fresh;
  }
  void reallocate(std::size_t capacity) {
    if constexpr (std::is_trivially_copyable_v<T>) {
      void* memory = std::realloc(static_cast<void*>(block_), bytes(capacity));
      if (!memory) throw std::bad_alloc();
      block_ = static_cast<Block*>(memory);
      block_->capacity = capacity;
    } else {
      Block* fresh = allocate(capacity);
      T* from = elements(block_);
      for (std::size_t i = 0; i < block_->size; ++i) {
        new (elements(fresh) + i) T(std::move(from[i]));
        from[i].~T();
      }
      fresh->size = block_->size;
      std::free(block_);
      block_ = fresh;
    }
  }
  void release() {
    if (!block_ || block_->references.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    if constexpr (!std::is_trivially_destructible_v<T>) {
      T* first = elements(block_);
      for (std::size_t i = 0; i < block_->size; ++i) first[i].~T();
    }
    std::free(block_);
  }

  Block* block_ = nullptr;
};

}  // namespace gs
