#include "vrml/scene/node_arena.h"

#include <algorithm>
#include <memory>
#include <new>

namespace gs::vrml {
namespace {

std::uint64_t slot_key(NodeId id, int slot) { return std::uint64_t{id.index} << 32 | static_cast<std::uint32_t>(slot); }

// Returns the type that removed nodes get.
const NodeType& removed_type() {
  static const NodeType type;
  return type;
}

}  // namespace

NodeArena::NodeArena(SceneMemory& memory) : memory_(memory) { nodes_.emplace_back(); }

NodeArena::~NodeArena() {
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (nodes_[i].values) std::destroy_n(nodes_[i].values, nodes_[i].type->defaults.size());
}

std::uint32_t NodeArena::next_generation() {
  constexpr std::uint32_t kAtATime = 256;  // generations reserved at a time, because threads share the counter
  do {
    if (generations_left_ == 0) {
      generation_ = memory_.budget()->draw_generations(kAtATime);
      generations_left_ = kAtATime;
    }
    --generations_left_;
  } while (++generation_ == 1);  // repeats, because 0 is not a valid generation
  return generation_ - 1;
}

std::uint32_t NodeArena::reserve(std::uint32_t count) {
  if (!free_indices_.empty())
    if (const auto free = free_indices_.find(count); free != free_indices_.end() && !free->second.empty()) {
      const std::uint32_t first = free->second.back();
      free->second.pop_back();
      return first;
    }
  const std::size_t most = memory_.budget()->limits().nodes;
  if (count > most - std::min(this->count(), most) || !memory_.draw(count * sizeof(Node))) return 0;
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    Node& made = nodes_.emplace_back();
    made.type = &removed_type();
    made.in_prototype_body = true;
  }
  return first;
}

NodeId NodeArena::create(std::uint32_t index, const NodeType& type, const SourceText& text, std::uint32_t owner,
                         SourceLocation location) {
  const std::size_t count = type.defaults.size();
  FieldValue* values = nullptr;
  if (count != 0) {
    if (!values_.has_freed(count) && !memory_.draw(count * sizeof(FieldValue))) return {};
    values = values_.take(count);
    for (std::size_t i = 0; i < count; ++i) construct_copy(type.defaults[i], values + i);
  }
  Node& made = nodes_[index];
  made.type = &type;
  made.text = &text;
  made.values = values;
  made.value_capacity = static_cast<std::uint32_t>(count);
  made.location = location;
  made.in_prototype_body = false;
  made.owner = owner;
  made.generation = next_generation();
  ++revision_;
  const NodeId id{index, made.generation};
  if (owner != 0 || made.recycled) made_.push_back(id);
  return id;
}

void NodeArena::free(NodeId id, std::vector<NodeId>& more) {
  Node& n = nodes_[id.index];
  const auto count = n.type->defaults.size();
  for (std::size_t slot = 0; slot < count && !value_texts_.empty(); ++slot)
    value_texts_.erase(slot_key(id, static_cast<int>(slot)));
  if (n.expansion_first != 0 && !n.in_prototype_body) {
    const auto copies = static_cast<std::uint32_t>(n.type->prototype->nodes.size());
    for (std::uint32_t i = 0; i < copies; ++i) more.push_back(id_at(n.expansion_first + i));
    release(n.expansion_first, copies);
  }
  // The indices of copies are given back together with those of their instance.
  if (n.instance == 0) release(id.index, 1);
  values_.free(n.values, count, n.value_capacity);
  n = {};
  n.type = &removed_type();
  n.in_prototype_body = true;
  n.recycled = true;
  ++revision_;
}

void NodeArena::add_value(Node& n) {
  const std::size_t count = n.type->defaults.size() - 1;
  // Doubles the capacity, so that n declarations cost O(n) moves.
  if (count >= n.value_capacity) {
    const std::size_t capacity = std::max<std::size_t>(8, count * 2);
    // The values are needed even if the budget is exhausted.
    if (!values_.has_freed(capacity)) (void)memory_.draw(capacity * sizeof(FieldValue));
    FieldValue* values = values_.take(capacity);
    std::uninitialized_move_n(n.values, count, values);
    values_.free(n.values, count, n.value_capacity);
    n.values = values;
    n.value_capacity = static_cast<std::uint32_t>(capacity);
  }
  new (n.values + count) FieldValue(n.type->defaults.back());
}

bool NodeArena::extend(NodeId id, const NodeType& type) {
  Node& n = (*this)[id];
  const std::size_t used = n.type->defaults.size(), count = type.defaults.size();
  assert(used <= count);
  if (count > n.value_capacity) {
    if (!values_.has_freed(count) && !memory_.draw(count * sizeof(FieldValue))) return false;
    FieldValue* values = values_.take(count);
    std::uninitialized_move_n(n.values, used, values);
    values_.free(n.values, used, n.value_capacity);
    n.values = values;
    n.value_capacity = static_cast<std::uint32_t>(count);
  }
  std::uninitialized_copy(type.defaults.begin() + static_cast<std::ptrdiff_t>(used), type.defaults.end(),
                          n.values + used);
  n.type = &type;
  return true;
}

const SourceText& NodeArena::text_of(NodeId id, int slot) const {
  const auto found = value_texts_.find(slot_key(id, slot));
  return found == value_texts_.end() ? *(*this)[id].text : *found->second;
}

void NodeArena::set_text(NodeId id, int slot, const SourceText& text) {
  if (&text == (*this)[id].text)
    value_texts_.erase(slot_key(id, slot));
  else
    value_texts_[slot_key(id, slot)] = &text;
}

}  // namespace gs::vrml
