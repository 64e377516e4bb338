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

/// Vectors that the volume encoder finds, and their order. Only that encoder uses them.
namespace gs::qnv {

/// Vector before it is added to the result.
struct FoundVector {
  std::array<std::uint32_t, 3> voxel;
  std::uint32_t key;  // float bits of the vector's length; lengths are positive, so keys sort like lengths
  float value;
  glm::vec3 normal;

  [[nodiscard]] float length() const { return std::bit_cast<float>(key); }
};
static_assert(std::is_trivially_default_constructible_v<FoundVector>);

/// List that grows in pages, so that elements never move.
class FoundVectors {
 public:
  /// Maximum number of vectors; append() rejects further ones.
  static constexpr std::size_t kMax = 0xffffffffu;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] const FoundVector& operator[](std::size_t i) const { return pages_[i / kPage][i % kPage]; }

  /// Appends all vectors of `parts`, part by part, and clears the parts.
  void append(std::span<std::vector<FoundVector>> parts, unsigned threads);

  struct Entry {
    std::uint32_t key;  // decreases while the length grows
    std::uint32_t place;  // index of the vector in the list
  };
  /// Returns all vectors, longest first; vectors of equal length keep their order of insertion.
  [[nodiscard]] std::vector<Entry> longest_first(unsigned threads) const;

 private:
  static constexpr std::size_t kPage = std::size_t{1} << 15;
  std::vector<std::unique_ptr<FoundVector[]>> pages_;
  std::size_t size_ = 0;
};

}  // namespace gs::qnv
