#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace gs::qnv::displaced {

/// Sparse array of numbers. Entries are 0 until written. Memory is allocated in pages around written entries.
class NumberArray {
 public:
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Resizes the array; all entries become 0.
  void assign_zeros(std::size_t size) {
    size_ = size;
    pages_.clear();
    pages_.resize((size + kPage - 1) / kPage);
  }
  /// Allocates all pages. Afterwards, several threads may write different entries.
  void fill_pages() {
    for (auto& page : pages_)
      if (!page) page = std::make_unique<Page>();
  }
  std::int16_t operator[](std::size_t i) const {
    const auto& page = pages_[i / kPage];
    return page ? (*page)[i % kPage] : std::int16_t{0};
  }
  std::int16_t& operator[](std::size_t i) {
    auto& page = pages_[i / kPage];
    if (!page) page = std::make_unique<Page>();
    return (*page)[i % kPage];
  }
  /// Copies `count` entries, from index `first` on, to `to`.
  void copy(std::size_t first, std::size_t count, std::int16_t* to) const {
    while (count > 0) {
      const std::size_t at = first % kPage, some = std::min(count, kPage - at);
      if (const auto& page = pages_[first / kPage])
        std::copy_n(page->begin() + static_cast<std::ptrdiff_t>(at), some, to);
      else
        std::fill_n(to, some, std::int16_t{0});
      first += some;
      count -= some;
      to += some;
    }
  }
  /// Reports whether any of the `count` entries from index `first` on is not 0.
  [[nodiscard]] bool any(std::size_t first, std::size_t count) const {
    for (std::size_t i = first; i < first + count; ++i)
      if ((*this)[i] != 0) return true;
    return false;
  }

 private:
  static constexpr std::size_t kPage = 1024;
  using Page = std::array<std::int16_t, kPage>;
  std::vector<std::unique_ptr<Page>> pages_;
  std::size_t size_ = 0;
};

}  // namespace gs::qnv::displaced
