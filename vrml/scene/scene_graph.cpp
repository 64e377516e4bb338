#include "vrml/scene/scene_graph.h"

#include <atomic>
#include <memory>
#include <utility>

namespace gs::vrml {
namespace {

// Maximum length of a chain of PROTOs that each have an instance as first node. A PROTO cannot contain itself, but such
// a chain can be long.
constexpr int kMaxResolveSteps = 100'000;

std::uint64_t next_serial() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

}  // namespace

SceneGraph::SceneGraph(std::string file_name, const Limits& limits)
    : SceneGraph(std::move(file_name), std::make_shared<Budget>(limits)) {}

SceneGraph::SceneGraph(std::string file_name, std::shared_ptr<Budget> budget)
    : SourceText(std::move(file_name)),
      memory_(std::move(budget)),
      texts_(*this, memory_),
      nodes_(memory_),
      serial_(next_serial()) {}

SceneGraph::~SceneGraph() = default;

NodeId SceneGraph::create(const NodeType& type, SourceLocation location) {
  const std::uint32_t index = nodes_.reserve(1);
  if (index == 0) return {};
  const NodeId made = create_at(index, type, location);
  if (!made) nodes_.release(index, 1);
  return made;
}

NodeId SceneGraph::create_at(std::uint32_t index, const NodeType& type, SourceLocation location) {
  const std::uint32_t owner = texts_.writing_index();
  const NodeId made = nodes_.create(index, type, texts_.writing(), owner, location);
  if (made) texts_.add_node(owner);
  return made;
}

void SceneGraph::put_in_body(NodeId id, Prototype& prototype) {
  Node& n = node(id);
  assert(!n.in_prototype_body);
  n.in_prototype_body = true;
  n.expansion_first = static_cast<std::uint32_t>(prototype.nodes.size());
  prototype.nodes.push_back(id);
  texts_.remove_node(n.owner);
}

std::optional<std::uint32_t> place_in_body(const Prototype& prototype, NodeId id) {
  if (!prototype.scene->contains(id)) return {};
  const Node& node = prototype.scene->node(id);
  const bool inside = node.in_prototype_body && node.expansion_first < prototype.nodes.size() &&
                      prototype.nodes[node.expansion_first] == id;
  return inside ? std::optional(node.expansion_first) : std::nullopt;
}

void SceneGraph::declare(NodeId id, NodeType& type, InterfaceDeclaration declaration) {
  Node& n = node(id);
  assert(n.type == &type);
  const std::size_t count = type.defaults.size();
  type.declare(std::move(declaration));
  if (type.defaults.size() != count) nodes_.add_value(n);
}

void SceneGraph::remove(std::span<const NodeId> ids) {
  std::vector<NodeId> waiting(ids.begin(), ids.end());
  std::vector<std::uint32_t> owners;
  while (!waiting.empty()) {
    const NodeId id = waiting.back();
    waiting.pop_back();
    if (!contains(id)) continue;
    const std::uint32_t owner = node(id).owner;
    if (!node(id).in_prototype_body && texts_.remove_node(owner)) owners.push_back(owner);
    free_node(id, waiting);
  }
  for (const std::uint32_t owner : owners) remove_text_if_unused(owner);
}

// Frees a node. Appends the nodes that must be freed with it to `more`.
void SceneGraph::free_node(NodeId id, std::vector<NodeId>& more) {
  inlines_.forget(id);
  nodes_.free(id, more);
}

// The nodes of PROTO bodies are freed with their types, which have no instances any more.
void SceneGraph::remove_text_if_unused(std::uint32_t index) {
  if (!texts_.is_unused(index)) return;
  std::vector<NodeId> none;
  for (const auto& type : texts_.at(index).types())
    for (std::size_t i = 0; type->kind == NodeType::Kind::prototype && i < type->prototype->nodes.size(); ++i)
      if (contains(type->prototype->nodes[i])) free_node(type->prototype->nodes[i], none);
  texts_.erase(index);
}

NodeId SceneGraph::resolve(NodeId id) const {
  for (int step = 0; step < kMaxResolveSteps && contains(id); ++step) {
    const Node& n = node(id);
    if (n.type->kind == NodeType::Kind::built_in || n.type->kind == NodeType::Kind::script) return id;
    if (n.expansion.empty()) return {};
    id = n.expansion.front();
  }
  return {};
}

NodeId SceneGraph::resolve_as(NodeId id, NodeKind kind) const {
  const NodeId resolved = resolve(id);
  return resolved && node(resolved).type->read_as == kind ? resolved : NodeId{};
}

RunTimeText::RunTimeText(SceneGraph& scene, std::string file_name, const SourceText& written_by,
                         std::shared_ptr<const TextSource> fetched_from)
    : scene_(scene), owner_(scene.texts().open(std::move(file_name), written_by, std::move(fetched_from))) {
  writing_.emplace(scene, owner_);
}

RunTimeText::~RunTimeText() {
  writing_.reset();
  scene_.texts().close(owner_);
  scene_.remove_text_if_unused(owner_);
}

}  // namespace gs::vrml
