#pragma once

#include "vrml/scene/values/field_value.h"

#include <cstddef>
#include <memory>
#include <unordered_map>
#include <vector>

namespace gs::vrml {

/// Storage for the values of nodes. Freed values are used again; blocks are freed with the pool. One thread.
class ValuePool {
 public:
  /// Reports whether freed values for `count` exist, so that take() needs no further memory.
  [[nodiscard]] bool has_freed(std::size_t count) const;
  /// Returns uninitialized storage for `count` values.
  [[nodiscard]] FieldValue* take(std::size_t count);
  /// Destroys the first `used` values and keeps the storage of `capacity` values. Ignores null.
  void free(FieldValue* values, std::size_t used, std::size_t capacity);

 private:
  std::vector<std::unique_ptr<std::byte[]>> blocks_;
  std::size_t block_left_ = 0;  // unused values of the last block
  std::byte* block_next_ = nullptr;
  std::unordered_map<std::size_t, std::vector<FieldValue*>> freed_;  // by capacity
};

}  // namespace gs::vrml
