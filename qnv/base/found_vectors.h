#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

/// The vectors that an encoder of volumes has found, and their order. Only for it.
namespace gs::qnv {

/// A vector on its way into a cloud.
struct FoundVector {
  std::array<std::uint32_t, 3> voxel;
  std::uint32_t key;  // the bits of its length, which is positive: as integers they are in the order of the floats
  float value;
  glm::vec3 normal;

  [[nodiscard]] float length() const { return std::bit_cast<float>(key); }
};
static_assert(std::is_trivially_default_constructible_v<FoundVector>);

/// A list that grows without moving what it has.
class FoundVectors {
 public:
  /// More are not taken.
  static constexpr std::size_t kMost = 0xffffffffu;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const FoundVector& operator[](std::size_t i) const { return pages_[i / kPage][i % kPage]; }

  /// Appends the parts in their order, and empties them.
  void append(std::span<std::vector<FoundVector>> parts, unsigned threads);

  struct Entry {
    std::uint32_t key;    // rises as lengths fall
    std::uint32_t place;  // in the list
  };
  /// All, longest first, equally long ones in the order in which they were appended.
  [[nodiscard]] std::vector<Entry> longest_first(unsigned threads) const;

 private:
  static constexpr std::size_t kPage = std::size_t{1} << 15;
  std::vector<std::unique_ptr<FoundVector[]>> pages_;
  std::size_t size_ = 0;
};

}  // namespace gs::qnv
