#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace gs::qnv {

/// Mixes the bits of a key, so that low bits depend on all bits.
[[nodiscard]] constexpr std::uint64_t mixed_key(std::uint64_t key) {
  key *= 0x9e3779b97f4a7c15ULL;
  return key ^ key >> 32;
}

/// Hash table (open addressing) that numbers distinct keys in the order of their first use. At most 2^32 - 1 keys.
class KeyTable {
 public:
  /// Returns the number of a key. Adds a new key, with the previous size() as its number.
  std::uint32_t add(std::uint64_t key) {
    if (keys_.size() * 2 >= table_.size()) grow();
    std::size_t slot = first_slot(key);
    for (; table_[slot] != 0; slot = (slot + 1) & (table_.size() - 1))
      if (keys_[table_[slot] - 1] == key) return table_[slot] - 1;
    keys_.push_back(key);
    table_[slot] = static_cast<std::uint32_t>(keys_.size());
    return table_[slot] - 1;
  }
  [[nodiscard]] std::size_t size() const { return keys_.size(); }
  [[nodiscard]] const std::vector<std::uint64_t>& keys() const { return keys_; }

 private:
  [[nodiscard]] std::size_t first_slot(std::uint64_t key) const {
    return static_cast<std::size_t>(mixed_key(key)) & (table_.size() - 1);
  }
  void grow() {
    table_.assign(std::max<std::size_t>(1024, table_.size() * 2), 0);
    for (std::size_t i = 0; i < keys_.size(); ++i) {
      std::size_t slot = first_slot(keys_[i]);
      while (table_[slot] != 0) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = static_cast<std::uint32_t>(i + 1);
    }
  }

  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> table_;  // number + 1; 0 means free
};

}  // namespace gs::qnv
