#include "vrml/scene/scene_graph.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <new>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kValuesPerBlock = 4096;
// Maximum length of a chain of PROTOs that each have an instance as first node. A PROTO cannot contain itself, but such
// a chain can be long.
constexpr int kMaxResolveSteps = 100'000;

std::uint64_t slot_key(NodeId id, int slot) { return std::uint64_t{id.index} << 32 | static_cast<std::uint32_t>(slot); }

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

// Returns the type that removed nodes get.
const NodeType& removed_type() {
  static const NodeType type;
  return type;
}

}  // namespace

SceneGraph::SceneGraph(std::string file_name, const Limits& limits)
    : SceneGraph(std::move(file_name), std::make_shared<Budget>(limits)) {}

SceneGraph::SceneGraph(std::string file_name, std::shared_ptr<Budget> budget)
    : SourceText(std::move(file_name)),
      budget_(std::move(budget)),
      nodes_share_(budget_, Resource::nodes),
      instances_share_(budget_, Resource::instances),
      serial_(next_serial()) {
  nodes_.emplace_back();
}

SceneGraph::~SceneGraph() {
  for (Node& n : nodes_)
    if (n.values) std::destroy_n(n.values, n.type->defaults.size());
}

// ---- Nodes: indices and values are used again and stay charged to the budget.

// Allocates values. Returns null if the budget is exhausted, unless `needed` is set.
FieldValue* SceneGraph::allocate_values(std::size_t count, bool needed) {
  if (!free_values_.empty())
    if (const auto free = free_values_.find(count); free != free_values_.end() && !free->second.empty()) {
      FieldValue* const values = free->second.back();
      free->second.pop_back();
      return values;
    }
  if (!draw(count * sizeof(FieldValue)) && !needed) return nullptr;
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

void SceneGraph::free_values(FieldValue* values, std::size_t used, std::size_t capacity) {
  if (!values) return;
  std::destroy_n(values, used);
  free_values_[capacity].push_back(values);
}

std::uint32_t SceneGraph::next_generation() {
  constexpr std::uint32_t kAtATime = 256;  // generations reserved at a time, because threads share the counter
  do {
    if (generations_left_ == 0) {
      generation_ = budget_->draw_generations(kAtATime);
      generations_left_ = kAtATime;
    }
    --generations_left_;
  } while (++generation_ == 1);  // repeats, because 0 is not a valid generation
  return generation_ - 1;
}

std::uint32_t SceneGraph::reserve_places(std::uint32_t count) {
  if (!free_places_.empty())
    if (const auto free = free_places_.find(count); free != free_places_.end() && !free->second.empty()) {
      const std::uint32_t first = free->second.back();
      free->second.pop_back();
      return first;
    }
  if (count > limits().nodes - std::min(node_count(), limits().nodes) || !draw(count * sizeof(Node))) return 0;
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  for (std::uint32_t i = 0; i < count; ++i) {
    Node& made = nodes_.emplace_back();
    made.type = &removed_type();
    made.in_prototype_body = true;
  }
  return first;
}

void SceneGraph::release_places(std::uint32_t first, std::uint32_t count) { free_places_[count].push_back(first); }

NodeId SceneGraph::create(const NodeType& type, SourceLocation location) {
  const std::uint32_t place = reserve_places(1);
  if (place == 0) return {};
  const NodeId made = create_at(place, type, location);
  if (!made) release_places(place, 1);
  return made;
}

NodeId SceneGraph::create_at(std::uint32_t place, const NodeType& type, SourceLocation location) {
  const std::size_t count = type.defaults.size();
  FieldValue* const values = count == 0 ? nullptr : allocate_values(count, false);
  if (!values && count != 0) return {};
  std::uninitialized_copy(type.defaults.begin(), type.defaults.end(), values);
  Node& made = nodes_[place];
  made.type = &type;
  made.text = &writing();
  made.values = values;
  made.value_capacity = static_cast<std::uint32_t>(count);
  made.location = location;
  made.in_prototype_body = false;
  made.owner = writing_;
  made.generation = next_generation();
  ++revision_;
  const NodeId id{place, made.generation};
  if (writing_ != 0) ++texts_[writing_].nodes;
  if (writing_ != 0 || made.recycled) made_.push_back(id);
  return id;
}

void SceneGraph::put_in_body(NodeId id, Prototype& prototype) {
  Node& n = node(id);
  assert(!n.in_prototype_body);
  n.in_prototype_body = true;
  n.expansion_first = static_cast<std::uint32_t>(prototype.nodes.size());
  prototype.nodes.push_back(id);
  if (n.owner != 0) --texts_[n.owner].nodes;
}

std::optional<std::uint32_t> place_in_body(const Prototype& prototype, NodeId id) {
  if (!prototype.scene->contains(id)) return {};
  const Node& node = prototype.scene->node(id);
  const bool inside = node.in_prototype_body && node.expansion_first < prototype.nodes.size() &&
                      prototype.nodes[node.expansion_first] == id;
  return inside ? std::optional(node.expansion_first) : std::nullopt;
}

void SceneGraph::remove(std::span<const NodeId> ids) {
  std::vector<NodeId> waiting(ids.begin(), ids.end());
  std::vector<std::uint32_t> owners;
  while (!waiting.empty()) {
    const NodeId id = waiting.back();
    waiting.pop_back();
    if (!contains(id)) continue;
    const std::uint32_t owner = nodes_[id.index].owner;
    if (owner != 0 && !nodes_[id.index].in_prototype_body && --texts_[owner].nodes == 0) owners.push_back(owner);
    free_node(id, waiting);
  }
  for (const std::uint32_t owner : owners) end_text_if_unused(owner);
}

// Frees a node. Appends the nodes that must be freed with it to `more`.
void SceneGraph::free_node(NodeId id, std::vector<NodeId>& more) {
  Node& n = nodes_[id.index];
  const auto count = n.type->defaults.size();
  inlines_.erase(id.index);
  for (std::size_t slot = 0; slot < count && !value_texts_.empty(); ++slot)
    value_texts_.erase(slot_key(id, static_cast<int>(slot)));
  if (n.expansion_first != 0 && !n.in_prototype_body) {
    const auto copies = static_cast<std::uint32_t>(n.type->prototype->nodes.size());
    for (std::uint32_t i = 0; i < copies; ++i) more.push_back(id_at(n.expansion_first + i));
    release_places(n.expansion_first, copies);
  }
  // The indices of copies are given back together with those of their instance.
  if (n.instance == 0) release_places(id.index, 1);
  free_values(n.values, count, n.value_capacity);
  n = {};
  n.type = &removed_type();
  n.in_prototype_body = true;
  n.recycled = true;
  ++revision_;
}

// ---- Texts

RunTimeText::RunTimeText(SceneGraph& scene, std::string file_name, const SourceText& written_by,
                         std::shared_ptr<const TextSource> fetched_from)
    : scene_(scene) {
  if (scene.free_texts_.empty()) {
    scene.free_texts_.push_back(static_cast<std::uint32_t>(scene.texts_.size()));
    scene.texts_.emplace_back();
  }
  owner_ = scene.free_texts_.back();
  scene.free_texts_.pop_back();
  scene.texts_[owner_] = {std::make_unique<SourceText>(std::move(file_name))};
  SourceText& text = *scene.texts_[owner_].text;
  text.origin_ = &written_by.origin();
  text.computed_ = fetched_from == nullptr;
  text.source_ = fetched_from ? std::move(fetched_from) : written_by.source();
  scene.texts_[owner_].open = true;
  writing_.emplace(scene, owner_);
  (void)scene.charge(sizeof(SourceText) + sizeof(SceneGraph::OwnedText));
}

RunTimeText::~RunTimeText() {
  writing_.reset();
  scene_.texts_[owner_].open = false;
  scene_.end_text_if_unused(owner_);
}

// Frees a text without nodes. The nodes of PROTO bodies are freed with their types, which have no instances any more.
void SceneGraph::end_text_if_unused(std::uint32_t owner) {
  OwnedText& ended = texts_[owner];
  if (!ended.text || ended.nodes != 0 || ended.open) return;
  std::vector<NodeId> none;
  for (const auto& type : ended.text->types_)
    for (std::size_t i = 0; type->kind == NodeType::Kind::prototype && i < type->prototype->nodes.size(); ++i)
      if (contains(type->prototype->nodes[i])) free_node(type->prototype->nodes[i], none);
  charged_ -= ended.charged;
  expanded_nodes_ -= ended.expanded_nodes;
  instances_share_.shrink_to(instances_share_.amount() - ended.expanded_bytes);
  constexpr std::size_t kSpare = std::size_t{1} << 20;
  if (nodes_share_.amount() > charged_ + kSpare) nodes_share_.shrink_to(charged_);
  exhausted_ = false;
  ended = {};
  free_texts_.push_back(owner);
}

std::uint32_t SceneGraph::owner_of(const NodeType& type) const {
  for (std::uint32_t i = 1; i < texts_.size(); ++i)
    for (std::size_t k = 0; texts_[i].text && k < texts_[i].text->types_.size(); ++k)
      if (texts_[i].text->types_[k].get() == &type) return i;
  return 0;
}

std::optional<std::uint32_t> SceneGraph::text_declaring(const NodeType* type) const {
  const auto is_it = [type](const auto& one) { return one.get() == type; };
  for (std::uint32_t i = 0; i < texts_.size(); ++i)
    if (i == 0 || texts_[i].text)
      if (const auto& types = text_at(i).types(); std::any_of(types.begin(), types.end(), is_it)) return i;
  return std::nullopt;
}

// ---- The budget

bool SceneGraph::draw(std::size_t bytes) {
  constexpr std::size_t kStep = std::size_t{64} << 10;  // bytes charged at a time, because threads share the counter
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

bool SceneGraph::charge(std::size_t bytes) {
  if (!draw(bytes)) return false;
  if (writing_ != 0) texts_[writing_].charged += bytes;
  return true;
}

bool SceneGraph::reserve_expansion(std::size_t count, std::size_t bytes) {
  if (count > limits().expanded_nodes - expanded_nodes_ || !instances_share_.grow(bytes)) return false;
  expanded_nodes_ += count;
  if (writing_ != 0) {
    texts_[writing_].expanded_nodes += count;
    texts_[writing_].expanded_bytes += bytes;
  }
  return true;
}

// ---- Looking up

NodeId SceneGraph::resolve(NodeId id) const {
  for (int step = 0; step < kMaxResolveSteps && contains(id); ++step) {
    const Node& n = nodes_[id.index];
    if (n.type->kind == NodeType::Kind::built_in || n.type->kind == NodeType::Kind::script) return id;
    if (n.expansion.empty()) return {};
    id = n.expansion.front();
  }
  return {};
}

NodeId SceneGraph::resolve_as(NodeId id, NodeKind kind) const {
  const NodeId resolved = resolve(id);
  return resolved && nodes_[resolved.index].type->read_as == kind ? resolved : NodeId{};
}

const SourceText& SceneGraph::text_of(NodeId id, int slot) const {
  const auto found = value_texts_.find(slot_key(id, slot));
  return found == value_texts_.end() ? *node(id).text : *found->second;
}

void SceneGraph::set_text(NodeId id, int slot, const SourceText& text) {
  if (&text == node(id).text)
    value_texts_.erase(slot_key(id, slot));
  else
    value_texts_[slot_key(id, slot)] = &text;
}

void SceneGraph::set_name(NodeId id, std::string_view name) { node(id).name = *keep_name(name); }

const std::string* SceneGraph::keep_name(std::string_view name) {
  constexpr std::size_t kEntry = 96;  // bytes of an entry here and in the scope that looks it up
  (void)charge(name.size() + kEntry);
  return &writing().names_.emplace_front(name);
}

void SceneGraph::declare(NodeId id, NodeType& type, InterfaceDeclaration declaration) {
  Node& n = node(id);
  assert(n.type == &type);
  const std::size_t count = type.defaults.size();
  type.declare(std::move(declaration));
  if (type.defaults.size() == count) return;
  // Doubles the capacity, so that n declarations cost O(n) moves.
  if (count >= n.value_capacity) {
    const std::size_t capacity = std::max<std::size_t>(8, count * 2);
    FieldValue* values = allocate_values(capacity, true);
    std::uninitialized_move_n(n.values, count, values);
    free_values(n.values, count, n.value_capacity);
    n.values = values;
    n.value_capacity = static_cast<std::uint32_t>(capacity);
  }
  new (n.values + count) FieldValue(type.defaults.back());
}

void SceneGraph::attach_inline(NodeId inline_node, std::shared_ptr<SceneGraph> content) {
  if (content)
    inlines_[inline_node.index] = std::move(content);
  else
    inlines_.erase(inline_node.index);
}

SceneGraph* SceneGraph::inlined(NodeId inline_node) const {
  const auto found = inlines_.find(inline_node.index);
  return found == inlines_.end() ? nullptr : found->second.get();
}

}  // namespace gs::vrml
