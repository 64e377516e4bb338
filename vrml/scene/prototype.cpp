#include "vrml/scene/prototype.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {
namespace {

std::uint64_t bytes_of(const NodeType& type) { return sizeof(Node) + type.defaults.size() * sizeof(FieldValue); }

// Copier of the nodes of a PROTO's body from one arena into another, or into the same one. If the source is another
// scene, it also copies all other nodes that the values refer to.
class Copier {
 public:
  Copier(SceneGraph& to, const Prototype& prototype) : to_(to), from_(*prototype.scene), prototype_(prototype) {}

  // Copies all nodes of the body. Returns false if there is no memory for them.
  bool copy_body(std::uint32_t& first) {
    const std::vector<NodeId>& body = prototype_.nodes;
    if (body.empty() || !to_.memory().reserve_expansion(body.size(), prototype_.body_bytes)) return false;
    const auto count = static_cast<std::uint32_t>(body.size());
    first = to_.nodes().reserve(count);
    if (first == 0) return false;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Node& original = from_.node(body[i]);
      if (to_.create_at(first + i, *original.type, original.location)) continue;
      std::vector<NodeId> made;
      for (std::uint32_t k = 0; k < i; ++k) made.push_back(to_.nodes().id_at(first + k));
      to_.remove(made);
      return false;
    }
    first_ = first;
    for (std::size_t i = 0; i < body.size(); ++i) copy_values(from_.node(body[i]), copy_at(i));
    return true;
  }

  NodeId of(NodeId original) {
    if (const auto place = place_in_body(prototype_, original)) return copy_at(*place);
    return &from_ == &to_ ? original : import(original);
  }

  /// Returns the copies of nodes outside the body.
  [[nodiscard]] const std::vector<NodeId>& imported() const { return made_; }

  /// Copies the nodes of the source scene that a value refers to. Returns the value with the copies.
  FieldValue import(FieldValue value) {
    if (&from_ != &to_) rewrite(value);
    return value;
  }

 private:
  NodeId copy_at(std::size_t place) const { return to_.nodes().id_at(first_ + static_cast<std::uint32_t>(place)); }

  void copy_values(const Node& original, NodeId made) {
    Node& copy = to_.node(made);
    copy.name = original.name;
    copy.text = original.text;
    copy.fields_set = original.fields_set;
    for (std::size_t i = 0; i < original.type->defaults.size(); ++i) {
      assign(original.values[i], copy.values[i]);
      rewrite(copy.values[i]);
    }
  }

  void rewrite(FieldValue& value) {
    if (auto* node = std::get_if<SFNode>(&value)) {
      if (*node) *node = of(*node);
    } else if (auto* nodes = std::get_if<MFNode>(&value)) {
      (void)to_.memory().charge(nodes->size() * sizeof(NodeId));
      for (std::size_t i = 0; i < nodes->size(); ++i) {
        const NodeId copy = (*nodes)[i] ? of((*nodes)[i]) : NodeId{};
        nodes->mutable_data()[i] = copy;
      }
    }
  }

  // Copies a node outside the body from another scene, at most once. Follows its references with a work list, so that
  // long chains need no call stack.
  NodeId import(NodeId original) {
    const auto known = imported_.find(original.index);
    if (known != imported_.end()) return known->second;
    if (!from_.contains(original)) return {};
    const Node& node = from_.node(original);
    if (!to_.memory().reserve_expansion(1, bytes_of(*node.type))) return {};
    const NodeId made = to_.create(*node.type, node.location);
    imported_[original.index] = made;
    if (!made) return {};
    made_.push_back(made);
    waiting_.push_back(original);
    if (waiting_.size() > 1) return made;  // an outer call already runs the loop below
    for (std::size_t i = 0; i < waiting_.size(); ++i)
      copy_values(from_.node(waiting_[i]), imported_[waiting_[i].index]);
    waiting_.clear();
    return made;
  }

  SceneGraph& to_;
  const SceneGraph& from_;
  const Prototype& prototype_;
  std::uint32_t first_ = 0;
  std::unordered_map<std::uint32_t, NodeId> imported_;
  std::vector<NodeId> waiting_, made_;
};

// Adds the ROUTEs of an instance from and to nodes that the content of its Inlines exports.
void add_imported_routes(SceneGraph& scene, const Prototype& prototype, Copier& copier) {
  using End = X3DStatements::RouteEnd;
  if (!prototype.shared) return;
  std::unordered_map<std::string_view, const X3DStatements::Import*> imports;
  for (const X3DStatements::Import& each : prototype.shared->imports) imports.try_emplace(each.local, &each);
  for (const X3DStatements::ImportedRoute& route : prototype.shared->routes) {
    X3DStatements::ImportedRoute made = route;
    if (!scene.memory().charge(sizeof made + made.from.name.size() + made.to.name.size())) return;
    bool complete = true;
    for (End* const end : {&made.from, &made.to}) {
      if (end->node) {
        end->node = copier.of(end->node);
        continue;
      }
      const auto found = imports.find(end->name);
      complete = complete && found != imports.end() && found->second->inline_node;
      if (!complete) break;
      end->inline_node = copier.of(found->second->inline_node);
      end->name = found->second->exported;
    }
    if (complete) scene.inlines().instance_routes().push_back(std::move(made));
  }
}

// Expands one instance. Appends the instances inside it, and those among imported nodes, to `inner`.
bool instantiate_one(SceneGraph& scene, NodeId instance, std::vector<NodeId>& inner) {
  const NodeType& type = *scene.node(instance).type;
  if (!type.prototype || !type.prototype->complete) return true;
  if (!scene.node(instance).expansion.empty() || scene.node(instance).in_prototype_body) return true;
  const Prototype& prototype = *type.prototype;
  if (prototype.nodes.empty()) return true;
  Copier copier(scene, prototype);
  std::uint32_t first = 0;
  const WritingFor writing(scene, scene.node(instance).owner);
  if (!copier.copy_body(first)) return false;
  for (const IsMapping& mapping : prototype.mappings) {
    if (mapping.inner->slot < 0 || mapping.outer->slot < 0) continue;
    // An EXTERNPROTO may declare fewer interfaces than the PROTO. The others keep the values of the PROTO.
    const InterfaceDeclaration* own = type.find_field(mapping.outer->name);
    const bool has_own = own && own->type == mapping.outer->type;
    FieldValue value = has_own ? scene.node(instance).values[own->slot] : copier.import(mapping.outer->initial);
    const NodeId inner_id = copier.of(mapping.node);
    Node& inner_node = scene.node(inner_id);
    // Only URLs depend on the text in which they were written.
    if (std::holds_alternative<MFString>(value))
      scene.nodes().set_text(inner_id, mapping.inner->slot,
                             has_own ? text_of_field(scene, instance, *own) : *prototype.text);
    inner_node.values[mapping.inner->slot] = std::move(value);
    if (mapping.inner->slot < 64) inner_node.fields_set |= std::uint64_t{1} << mapping.inner->slot;
  }
  MFNode expansion;
  for (const Statement& statement : prototype.statements) {
    if (statement.kind == Statement::Kind::node) expansion.push_back(copier.of(statement.node));
    if (statement.kind == Statement::Kind::route && scene.memory().charge(sizeof(Route)))
      scene.routes().push_back({copier.of(statement.route.from), copier.of(statement.route.to),
                                statement.route.event_out, statement.route.event_in});
  }
  add_imported_routes(scene, prototype, copier);
  scene.node(instance).expansion = expansion;
  scene.node(instance).expansion_first = first;
  const auto add_inner = [&](NodeId made) {
    if (scene.node(made).type->prototype) inner.push_back(made);
  };
  for (std::uint32_t i = 0; i < prototype.nodes.size(); ++i) {
    const NodeId made = scene.nodes().id_at(first + i);
    scene.node(made).instance = instance.index;
    add_inner(made);
  }
  for (const NodeId made : copier.imported()) add_inner(made);
  return true;
}

}  // namespace

bool instantiate(SceneGraph& scene, NodeId instance) {
  const NodeType& type = *scene.node(instance).type;
  const bool counts = type.prototype && !scene.node(instance).in_prototype_body;
  if (counts && type.prototype->instance_bytes > scene.budget()->left(Resource::instances)) return false;
  constexpr std::size_t kBetweenLooks = 256;  // number of nodes between two tests for cancellation
  std::vector<NodeId> waiting{instance};
  for (std::size_t made = 1; !waiting.empty(); ++made) {
    if (made % kBetweenLooks == 0 && scene.budget()->stopped()) return false;
    const NodeId next = waiting.back();
    waiting.pop_back();
    if (!instantiate_one(scene, next, waiting)) return false;
  }
  return true;
}

const SourceText& text_of_field(const SceneGraph& scene, NodeId instance, const InterfaceDeclaration& field) {
  const Node& node = scene.node(instance);
  const bool given = field.slot < 64 && (node.fields_set >> field.slot & 1);
  return given || !node.type->prototype ? scene.nodes().text_of(instance, field.slot) : *node.type->prototype->text;
}

void count_instance_nodes(const SceneGraph& scene, Prototype& prototype) {
  constexpr std::uint64_t kEnough = std::uint64_t{1} << 48;  // limit that prevents overflow in sums
  for (const NodeId id : prototype.nodes) {
    const NodeType& type = *scene.node(id).type;
    prototype.body_bytes += bytes_of(type);
    ++prototype.instance_nodes;
    if (!type.prototype) continue;
    prototype.instance_nodes = std::min(kEnough, prototype.instance_nodes + type.prototype->instance_nodes);
    prototype.instance_bytes = std::min(kEnough, prototype.instance_bytes + type.prototype->instance_bytes);
  }
  prototype.instance_bytes = std::min(kEnough, prototype.instance_bytes + prototype.body_bytes);
}

std::string why_not_expanded(const SceneGraph& scene, const NodeType& type) {
  const Budget& budget = *scene.budget();
  std::string text = "instances of PROTO " + type.name;
  if (type.prototype && type.prototype->instance_nodes > 0)
    text += ", which make " + std::to_string(type.prototype->instance_nodes) + " nodes each,";
  text += " make ";
  if (scene.memory().exhausted()) return text + budget.refusal(Resource::nodes);
  const std::uint64_t bytes = type.prototype ? type.prototype->body_bytes : 0;
  if (bytes <= budget.left(Resource::instances) && type.prototype &&
      type.prototype->instance_bytes <= budget.left(Resource::instances))
    return text + "more than " + std::to_string(scene.limits().expanded_nodes) + " nodes";
  return text + budget.refusal(Resource::instances);
}

bool resolve_external(SceneGraph& scene, NodeType& external, const NodeType& source) {
  if (external.prototype || !source.prototype) return true;
  external.prototype = std::make_unique<Prototype>(*source.prototype);
  external.role = source.role;
  const WritingFor writing(scene, scene.texts().declaring(&external).value_or(0));
  Copier copier(scene, *external.prototype);
  // Visits only existing nodes. Nodes that are created below get their values from these.
  const auto count = static_cast<std::uint32_t>(scene.nodes().count());
  for (const InterfaceDeclaration& declaration : external.interfaces) {
    if (declaration.slot < 0) continue;
    const InterfaceDeclaration* given = source.find_field(declaration.name);
    if (!given || given->type != declaration.type) continue;
    const FieldValue value = copier.import(given->initial);
    external.defaults[declaration.slot] = value;
    for (std::uint32_t i = 1; i <= count; ++i) {
      const Node& node = scene.nodes().at(i);
      const bool set = declaration.slot >= 64 || (node.fields_set >> declaration.slot & 1);
      if (node.type == &external && !set) node.values[declaration.slot] = value;
    }
  }
  for (std::uint32_t i = 1; i <= count; ++i)
    if (scene.nodes().at(i).type == &external && !instantiate(scene, scene.nodes().id_at(i))) return false;
  return true;
}

const InterfaceDeclaration* unlike_prototype(const NodeType& external, const NodeType& source) {
  for (const InterfaceDeclaration& declaration : external.interfaces) {
    const InterfaceDeclaration* given = source.find(declaration.name);
    const bool same = given && given->type == declaration.type &&
                      (given->access == declaration.access || given->access == AccessType::exposedField);
    if (!same) return &declaration;
  }
  return nullptr;
}

const NodeType* find_prototype(const SourceText& text, std::string_view name) {
  for (const Statement& statement : text.statements())
    if (statement.kind == Statement::Kind::prototype && (name.empty() || statement.type->name == name))
      return statement.type;
  return nullptr;
}

const NodeType* find_own_prototype(const SourceText& text, std::string_view name) {
  for (const Statement& statement : text.statements())
    if (statement.kind == Statement::Kind::prototype && statement.type->kind == NodeType::Kind::prototype &&
        statement.type->prototype->complete && (name.empty() || statement.type->name == name))
      return statement.type;
  return nullptr;
}

bool stands_inside(const NodeType& type, const NodeType& source) {
  std::vector<const NodeType*> waiting{&source};
  std::unordered_set<const NodeType*> seen{&source};
  while (!waiting.empty()) {
    const NodeType& next = *waiting.back();
    waiting.pop_back();
    if (!next.prototype) continue;
    for (const NodeId id : next.prototype->nodes) {
      const NodeType* inner = next.prototype->scene->node(id).type;
      if (inner == &type) return true;
      if (seen.insert(inner).second) waiting.push_back(inner);
    }
  }
  return false;
}

}  // namespace gs::vrml
