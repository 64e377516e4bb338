#pragma once

#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>
#include <vector>

namespace gs::vrml {

/// Flat hash table of nodes by name, with open addressing. A table with bucket lists would wait for memory three times
/// per look-up, and worlds with many ROUTEs consist mostly of look-ups. The names must outlive the table. One thread.
class NameTable {
 public:
  /// Returns the node of a name; null if there is none. Valid until the next insertion.
  [[nodiscard]] NodeId* find(std::string_view name) {
    if (entries_.empty()) return nullptr;
    const std::uint32_t index = slots_[slot_of(name, hash_of(name))].index;
    return index == 0 ? nullptr : &entries_[index - 1].node;
  }
  /// Returns the node of a name. If the name is new, inserts a null node.
  NodeId& insert(std::string_view name) {
    if (entries_.size() * 2 >= slots_.size()) grow();
    const std::uint32_t hash = hash_of(name);
    Slot& slot = slots_[slot_of(name, hash)];
    if (slot.index == 0) {
      entries_.push_back({name, {}});
      slot = {hash, static_cast<std::uint32_t>(entries_.size())};
    }
    return entries_[slot.index - 1].node;
  }

 private:
  struct Entry {
    std::string_view name;
    NodeId node;
  };
  struct Slot {
    std::uint32_t hash = 0, index = 0;  // index: 0 means free; otherwise 1 + index of the entry
  };

  static std::uint32_t hash_of(std::string_view name) {
    const std::size_t hash = std::hash<std::string_view>{}(name);
    return static_cast<std::uint32_t>(hash ^ hash >> 32);
  }
  /// Returns the slot of the name. If the name is not in the table, returns the free slot for it.
  [[nodiscard]] std::size_t slot_of(std::string_view name, std::uint32_t hash) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t at = hash & mask;
    while (slots_[at].index != 0 && (slots_[at].hash != hash || entries_[slots_[at].index - 1].name != name))
      at = (at + 1) & mask;
    return at;
  }
  void grow() {
    std::vector<Slot> old(slots_.empty() ? 16 : slots_.size() * 2);
    old.swap(slots_);
    const std::size_t mask = slots_.size() - 1;
    for (const Slot& slot : old) {
      if (slot.index == 0) continue;
      std::size_t at = slot.hash & mask;
      while (slots_[at].index != 0) at = (at + 1) & mask;
      slots_[at] = slot;
    }
  }

  std::vector<Entry> entries_;
  std::vector<Slot> slots_;
};

}  // namespace gs::vrml
