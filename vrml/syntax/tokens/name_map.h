#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>

namespace gs::vrml {

/// Constant table of values by name, for a few names that texts look up often. A look-up compares one name, as a rule.
template <class Value, std::size_t size>
class NameMap {
 public:
  constexpr NameMap(const std::pair<std::string_view, Value> (&rows)[size]) {
    for (std::size_t i = 0; i < size; ++i) {
      names_[i] = rows[i].first;
      values_[i] = rows[i].second;
      std::size_t slot = slot_of(names_[i]);
      while (slots_[slot] != 0) slot = (slot + 1) % kSlots;
      slots_[slot] = static_cast<std::uint8_t>(i + 1);
    }
  }

  /// Returns the value of a name, or `otherwise`.
  [[nodiscard]] constexpr Value find(std::string_view name, Value otherwise) const {
    for (std::size_t slot = slot_of(name); slots_[slot] != 0; slot = (slot + 1) % kSlots)
      if (names_[slots_[slot] - 1u] == name) return values_[slots_[slot] - 1u];
    return otherwise;
  }

 private:
  static constexpr std::size_t kSlots = std::bit_ceil(size * 4);
  static_assert(size < 255);

  static constexpr std::size_t slot_of(std::string_view name) {
    if (name.empty()) return 0;
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(name[i])); };
    return (name.size() * 5 + byte(0) * 3 + byte(name.size() / 2) * 17 + byte(name.size() - 1) * 7) % kSlots;
  }

  std::array<std::string_view, size> names_{};
  std::array<Value, size> values_{};
  std::array<std::uint8_t, kSlots> slots_{};  // 1 + row; 0 means free
};

}  // namespace gs::vrml
