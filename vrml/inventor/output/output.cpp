#include "vrml/inventor/output/output.h"

#include "vrml/syntax/tokens/lexer.h"

#include <glm/matrix.hpp>

#include <utility>

namespace gs::vrml::inventor {

NodeId Output::begin(std::string_view type, NodeTarget target, SourceLocation location, std::string_view name) {
  if (!is_id(name) || reserved_word(name, Language::vrml97) >= 0) name = {};
  const OpenNode node = sink_.begin_node({{type, location}, name, target, groups_.size() * 2});
  return node.id;
}

NodeId Output::begin_x3d(std::string_view type, NodeTarget target, SourceLocation location, std::string_view name) {
  SourceText& text = scene().texts().writing();
  const Language language = text.language();
  const int version = text.version();
  text.set_language(Language::x3d, version);
  const NodeId node = begin(type, target, location, name);
  text.set_language(language, version);
  return node;
}

NodeId Output::make(std::string_view type, NodeTarget target, SourceLocation location, std::string_view name) {
  const NodeId node = begin(type, target, location, name);
  if (node) end(node);
  return node;
}

void Output::place(NodeId node, NodeTarget target) {
  (void)scene().memory().charge(target.value ? sizeof(NodeId) : sizeof(Statement));
  if (!target.value)
    scene().texts().writing().add_root(node);
  else if (auto* list = std::get_if<MFNode>(target.value))
    list->push_back(node);
  else
    *target.value = SFNode{node};
}

NodeTarget Output::field(NodeId node, std::string_view name) {
  Node& owner = scene().node(node);
  const InterfaceDeclaration* const declaration = owner.type->find_field(name);
  return {&owner.values[declaration->slot], declaration->name};
}

void Output::open_group(std::string_view name, SourceLocation location) {
  Group group;
  group.name = name;
  group.location = location;
  groups_.push_back(std::move(group));
}

NodeId Output::open_group_in(NodeTarget target, std::string_view type, SourceLocation location, std::string_view name) {
  open_group(name, location);
  groups_.back().parent = target;
  return make_group(type);
}

NodeId Output::close_group() {
  const NodeId node = groups_.back().outer ? groups_.back().outer : groups_.back().node;
  const bool has_shapes = groups_.back().has_shapes;
  groups_.pop_back();
  groups_.back().has_shapes |= has_shapes;
  return node;
}

NodeId Output::make_group(std::string_view type) {
  Group& group = groups_.back();
  if (group.node) return group.node;
  const std::optional<NodeTarget> target = group.parent ? group.parent : target_in(groups_.size() - 2);
  if (target) groups_.back().node = make(type, *target, group.location, group.name);
  return groups_.back().node;
}

// Returns the target for children of a group without its later transforms. Makes the node of the group.
std::optional<NodeTarget> Output::node_target(std::size_t index) {
  if (index == 0 && !groups_[0].node) return NodeTarget{};
  if (!groups_[index].node) {
    const std::optional<NodeTarget> target = groups_[index].parent ? groups_[index].parent : target_in(index - 1);
    if (!target) return std::nullopt;
    Group& group = groups_[index];
    const bool moves = !group.operations.empty() && group.saved.empty();
    group.node = begin(moves ? "Transform" : "Group", *target, group.location, group.name);
    if (!group.node) return std::nullopt;
    if (moves) {
      group.base = group.operations.size();
      set_transform(group.node, group.operations);
    }
    end(group.node);
  }
  return field(groups_[index].node, "children");
}

std::optional<NodeTarget> Output::target_in(std::size_t index) {
  const std::optional<NodeTarget> inside = node_target(index);
  Group& group = groups_[index];
  if (!inside || group.operations.size() == group.base) return inside;
  if (!group.wrapper) {
    group.wrapper = begin("Transform", *inside, group.location);
    if (!group.wrapper) return std::nullopt;
    set_transform(group.wrapper, std::span(group.operations).subspan(group.base));
    end(group.wrapper);
  }
  return field(group.wrapper, "children");
}

std::optional<NodeTarget> Output::target() { return target_in(groups_.size() - 1); }
std::optional<NodeTarget> Output::group_target() { return node_target(groups_.size() - 1); }

void Output::set_transform(NodeId node, std::span<const Operation> operations) {
  bool inexact = false;
  const TransformFields fields = merge(operations, inexact);
  if (inexact)
    sink_.problems().warn_once(said_inexact_, scene().node(node).location,
                               "matrix has no exact Transform; approximated");
  const TransformFields none;
  if (fields.translation != none.translation) set(node, "translation", fields.translation);
  if (fields.center != none.center) set(node, "center", fields.center);
  if (!(fields.rotation == none.rotation)) set(node, "rotation", fields.rotation);
  if (fields.scale != none.scale) set(node, "scale", fields.scale);
  if (!(fields.scale_orientation == none.scale_orientation)) set(node, "scaleOrientation", fields.scale_orientation);
}

glm::dmat4 Output::inner_matrix() const {
  const Group& group = groups_.back();
  return product(std::span(group.operations).subspan(group.base));
}

glm::dmat4 Output::world_matrix() const {
  glm::dmat4 matrix(1);
  for (const Group& group : groups_) matrix = matrix * product(group.operations);
  return matrix;
}

// A long run of transforms becomes one matrix, so that each shape costs a bounded time.
void Output::add_transform(Operation operation) {
  constexpr std::size_t kLongest = 64;
  Group& group = groups_.back();
  group.wrapper = {};
  const std::size_t kept = group.saved.empty() ? group.base : group.saved.back();
  if (group.operations.size() - kept >= kLongest) {
    const glm::dmat4 matrix = product(std::span(group.operations).subspan(kept));
    group.operations.resize(kept);
    group.operations.push_back({{}, matrix});
  }
  group.operations.push_back(std::move(operation));
}

std::string Output::add_moving_transform(const TransformFields& fields, const std::string& name) {
  constexpr std::size_t kMaxMoving = 16;
  const std::size_t index = groups_.size() - 1;
  const bool can_move = groups_[index].saved.empty() && ++groups_[index].splits <= kMaxMoving;
  const std::optional<NodeTarget> inside = can_move ? node_target(index) : std::nullopt;
  const std::optional<NodeTarget> target = inside ? target_in(index) : std::nullopt;
  const NodeId node = target ? begin("Transform", *target, groups_[index].location, name) : NodeId{};
  const Operation operation{fields, {}};
  if (!node) {
    add_transform(operation);
    return {};
  }
  set_transform(node, std::span(&operation, 1));
  end(node);
  Group& group = groups_[index];
  if (index > 0 && !group.outer) group.outer = group.node;
  group.node = node;
  group.wrapper = {};
  group.operations.push_back(operation);
  group.base = group.operations.size();
  return name;
}

bool Output::add_script(const std::string& name, const std::string& code, std::initializer_list<Event> events,
                        NodeTarget target, SourceLocation location) {
  const OpenNode script = sink_.begin_node({{"Script", location}, name, target, groups_.size() * 2});
  if (!script.id) return false;
  for (const Event& event : events) {
    InterfaceDeclaration declaration;
    declaration.access = event.access;
    declaration.type = event.type;
    declaration.name = event.name;
    sink_.prototypes().declare(*script.own_type, script.id, std::move(declaration));
  }
  if (sink_.limits().admits_string(code.size(), location)) set(script.id, "url", MFString{String(code)});
  sink_.end_node(script.id);
  return true;
}

void Output::save_transforms() { groups_.back().saved.push_back(groups_.back().operations.size()); }

void Output::restore_transforms() {
  Group& group = groups_.back();
  const std::size_t count = group.saved.back();
  group.saved.pop_back();
  if (group.operations.size() == count) return;
  group.operations.resize(count);
  group.wrapper = {};
}

void Output::split_group(SourceLocation location) {
  constexpr std::size_t kMaxSplits = 16;
  const std::size_t index = groups_.size() - 1;
  if (!groups_[index].has_shapes || groups_[index].splits >= kMaxSplits) return;
  const std::optional<NodeTarget> inside = node_target(index);
  if (!inside) return;
  const NodeId node = make("Group", *inside, location);
  if (!node) return;
  Group& group = groups_[index];
  ++group.splits;
  if (index > 0 && !group.outer) group.outer = group.node;
  group.node = node;
  group.wrapper = {};
  group.has_shapes = false;
}

}  // namespace gs::vrml::inventor
