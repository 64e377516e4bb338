#include "vrml/scene/values/value_pool.h"

#include <algorithm>
#include <memory>

namespace gs::vrml {
namespace {

constexpr std::size_t kValuesPerBlock = 4096;

}  // namespace

bool ValuePool::has_freed(std::size_t count) const {
  if (freed_.empty()) return false;
  const auto free = freed_.find(count);
  return free != freed_.end() && !free->second.empty();
}

FieldValue* ValuePool::take(std::size_t count) {
  if (!freed_.empty())
    if (const auto free = freed_.find(count); free != freed_.end() && !free->second.empty()) {
      FieldValue* const values = free->second.back();
      free->second.pop_back();
      return values;
    }
  if (block_left_ < count) {
    const std::size_t size = std::max(count, kValuesPerBlock);
    blocks_.push_back(std::make_unique_for_overwrite<std::byte[]>(size * sizeof(FieldValue)));
    block_next_ = blocks_.back().get();
    block_left_ = size;
  }
  auto* values = reinterpret_cast<FieldValue*>(block_next_);
  block_next_ += count * sizeof(FieldValue);
  block_left_ -= count;
  return values;
}

void ValuePool::free(FieldValue* values, std::size_t used, std::size_t capacity) {
  if (!values) return;
  std::destroy_n(values, used);
  freed_[capacity].push_back(values);
}

}  // namespace gs::vrml
