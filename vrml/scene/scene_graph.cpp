#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kValuesPerBlock = 4096;
// A PROTO cannot contain itself, but a chain of PROTOs whose first node is an instance can be long.
constexpr int kMaxResolveSteps = 100'000;

std::uint64_t slot_key(NodeId id, int slot) { return std::uint64_t{id.index} << 32 | static_cast<std::uint32_t>(slot); }

}  // namespace

SceneGraph::SceneGraph(std::string file_name, const Limits& limits)
    : SceneGraph(std::move(file_name), std::make_shared<Budget>(limits)) {}

SceneGraph::SceneGraph(std::string file_name, std::shared_ptr<Budget> budget)
    : file_name_(std::move(file_name)),
      budget_(std::move(budget)),
      nodes_share_(budget_, Resource::nodes),
      instances_share_(budget_, Resource::instances) {
  nodes_.emplace_back();
  nodes_.front().generation = 0;
}

SceneGraph::~SceneGraph() {
  for (Node& n : nodes_)
    if (n.values) std::destroy_n(n.values, n.type->defaults.size());
}

FieldValue* SceneGraph::allocate_values(std::size_t count) {
  if (count == 0) return nullptr;
  if (block_left_ < count) {
    const std::size_t size = std::max(count, kValuesPerBlock);
    value_blocks_.push_back(std::make_unique_for_overwrite<std::byte[]>(size * sizeof(FieldValue)));
    block_next_ = value_blocks_.back().get();
    block_left_ = size;
  }
  auto* values = reinterpret_cast<FieldValue*>(block_next_);
  block_next_ += count * sizeof(FieldValue);
  block_left_ -= count;
  return values;
}

NodeId SceneGraph::create(const NodeType& type, SourceLocation location) {
  const std::size_t bytes = sizeof(Node) + type.defaults.size() * sizeof(FieldValue);
  if (node_count() >= limits().nodes || !charge(bytes)) return {};
  FieldValue* values = allocate_values(type.defaults.size());
  std::uninitialized_copy(type.defaults.begin(), type.defaults.end(), values);
  Node& made = nodes_.emplace_back();
  made.type = &type;
  made.text = this;
  made.values = values;
  made.value_capacity = static_cast<std::uint32_t>(type.defaults.size());
  made.location = location;
  return {static_cast<std::uint32_t>(nodes_.size() - 1), made.generation};
}

bool SceneGraph::charge(std::size_t bytes) {
  constexpr std::size_t kStep = std::size_t{64} << 10;  // drawn at a time: the counter is shared between threads
  if (exhausted_) return false;
  const std::size_t wanted = charged_ + bytes;
  if (wanted > nodes_share_.amount()) {
    const std::size_t missing = wanted - nodes_share_.amount();
    exhausted_ = !nodes_share_.grow(std::max(missing, kStep)) && !nodes_share_.grow(missing);
    if (exhausted_) return false;
  }
  charged_ = wanted;
  return true;
}

bool SceneGraph::reserve_expansion(std::size_t count, std::size_t bytes) {
  if (count > limits().expanded_nodes - expanded_nodes_ || !instances_share_.grow(bytes)) return false;
  expanded_nodes_ += count;
  return true;
}

NodeId SceneGraph::resolve(NodeId id) const {
  for (int step = 0; step < kMaxResolveSteps && contains(id); ++step) {
    const Node& n = nodes_[id.index];
    if (n.type->kind == NodeType::Kind::built_in || n.type->kind == NodeType::Kind::script) return id;
    if (n.expansion.empty()) return {};
    id = n.expansion.front();
  }
  return {};
}

NodeId SceneGraph::resolve_as(NodeId id, std::string_view type_name) const {
  const NodeId resolved = resolve(id);
  return resolved && nodes_[resolved.index].type->name == type_name ? resolved : NodeId{};
}

const SceneGraph& SceneGraph::text_of(NodeId id, int slot) const {
  const auto found = value_texts_.find(slot_key(id, slot));
  return found == value_texts_.end() ? *node(id).text : *found->second;
}

void SceneGraph::set_text(NodeId id, int slot, const SceneGraph& text) {
  if (&text == node(id).text)
    value_texts_.erase(slot_key(id, slot));
  else
    value_texts_[slot_key(id, slot)] = &text;
}

void SceneGraph::set_name(NodeId id, std::string_view name) { node(id).name = *keep_name(name); }

const std::string* SceneGraph::keep_name(std::string_view name) {
  constexpr std::size_t kEntry = 96;  // of it here, and of the scope that finds it
  (void)charge(name.size() + kEntry);
  return &names_.emplace_back(name);
}

void SceneGraph::declare(NodeId id, NodeType& type, InterfaceDeclaration declaration) {
  Node& n = node(id);
  assert(n.type == &type);
  const std::size_t count = type.defaults.size();
  type.declare(std::move(declaration));
  if (type.defaults.size() == count) return;
  // Places for values double, so that n declarations cost n moves.
  if (count >= n.value_capacity) {
    const std::size_t capacity = std::max<std::size_t>(8, count * 2);
    FieldValue* values = allocate_values(capacity);
    std::uninitialized_move_n(n.values, count, values);
    std::destroy_n(n.values, count);
    n.values = values;
    n.value_capacity = static_cast<std::uint32_t>(capacity);
  }
  new (n.values + count) FieldValue(type.defaults.back());
}

void SceneGraph::add_root(NodeId id) {
  roots_.push_back(id);
  statements_.push_back({Statement::Kind::node, id, nullptr, {}});
}

NodeType& SceneGraph::add_type(std::unique_ptr<NodeType> type) {
  types_.push_back(std::move(type));
  return *types_.back();
}

void SceneGraph::attach_inline(NodeId inline_node, std::unique_ptr<SceneGraph> content) {
  inlines_[inline_node.index] = std::move(content);
}

SceneGraph* SceneGraph::inlined(NodeId inline_node) const {
  const auto found = inlines_.find(inline_node.index);
  return found == inlines_.end() ? nullptr : found->second.get();
}

SceneGraph& SceneGraph::attach_library(std::unique_ptr<SceneGraph> library) {
  libraries_.push_back(std::move(library));
  return *libraries_.back();
}

}  // namespace gs::vrml
