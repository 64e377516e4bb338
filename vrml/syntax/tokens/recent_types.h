#pragma once

#include "vrml/scene/node_type.h"

#include <array>
#include <cstddef>
#include <string_view>

namespace gs::vrml {

/// Node types that were found last, by name. Texts name few types many times. One thread.
class RecentTypes {
 public:
  /// Returns a type with this name that was added for this language since the last clear(). Returns null if it was
  /// replaced or not added.
  [[nodiscard]] const NodeType* find(Language language, std::string_view name) {
    if (language != language_) clear();
    language_ = language;
    const NodeType* const type = types_[slot_of(name)];
    return type && type->name == name ? type : nullptr;
  }
  void add(const NodeType& type) { types_[slot_of(type.name)] = &type; }
  void clear() { types_ = {}; }

 private:
  static constexpr std::size_t kSlots = 64;

  static std::size_t slot_of(std::string_view name) {
    if (name.empty()) return 0;
    const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(name[i])); };
    return (name.size() * 5 + byte(0) * 3 + byte(name.size() / 2) * 17 + byte(name.size() - 1) * 7) % kSlots;
  }

  Language language_ = Language::vrml97;
  std::array<const NodeType*, kSlots> types_{};
};

}  // namespace gs::vrml
