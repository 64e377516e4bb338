#include "vrml/syntax/prototype_sink.h"

#include "vrml/scene/coordinates/units.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/scene_sink.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gs::vrml {
namespace {

// Reports whether `inner` of a node in a PROTO body may be IS `outer` of the PROTO's interface (VRML97 Table 4.4).
bool may_be_mapped(AccessType inner, AccessType outer) { return inner == outer || inner == AccessType::exposedField; }

}  // namespace

NodeType& PrototypeSink::begin_prototype(SourceName name, bool external) {
  auto type = std::make_unique<NodeType>();
  type->name = name.text;
  type->location = name.location;
  type->kind = external ? NodeType::Kind::external_prototype : NodeType::Kind::prototype;
  if (!external) {
    type->prototype = std::make_unique<Prototype>();
    type->prototype->scene = &sink_.scene_;
    type->prototype->text = &sink_.text_;
  }
  (void)sink_.scene_.memory().charge(sizeof(NodeType) + sizeof(Prototype));
  ++sink_.open_interfaces_;
  return sink_.text_.add_type(std::move(type));
}

bool PrototypeSink::may_declare(const NodeType& type, const InterfaceDeclaration& declaration,
                                SourceLocation location) {
  const bool script = type.kind == NodeType::Kind::script;
  if (script && declaration.access == AccessType::exposedField && sink_.text_.language() == Language::vrml97)
    sink_.problems_.warn(
        location, "a Script has no exposedFields in VRML97 (6.40); " + quoted(declaration.name) + " is accepted");
  const InterfaceDeclaration* const known = type.find(declaration.name);
  if (!known) return true;
  if (!script || known->access != declaration.access || known->type != declaration.type)
    sink_.problems_.error(location,
                          quoted(declaration.name) + " of " + type.name + " is declared twice; the first one is used");
  (void)sink_.scene_.memory().charge(sizeof(InterfaceDeclaration));
  return false;
}

void PrototypeSink::declare(NodeType& type, NodeId script, InterfaceDeclaration declaration) {
  (void)sink_.scene_.memory().charge(sizeof(InterfaceDeclaration));
  if (const double unit = sink_.measures_.units.of(measure_of(type, declaration)); unit != 1)
    scale_measures(declaration.initial, unit);
  if (script) {
    sink_.scene_.declare(script, type, std::move(declaration));
  } else {
    type.declare(std::move(declaration));
  }
}

void PrototypeSink::end_interface() { --sink_.open_interfaces_; }

void PrototypeSink::begin_body(NodeType& type) {
  SceneSink::Scope& scope = sink_.scopes_.emplace_back();
  scope.prototype = &type;
  scope.interfaces_around = sink_.open_interfaces_;
}

// Converts the default values of fields that IS connects to a measure. declare() has converted the rotations.
void PrototypeSink::convert_prototype(NodeType& type) {
  for (const IsMapping& mapping : type.prototype->mappings) {
    const bool converted =
        measure_of(type, *mapping.outer) != Measure::none || sink_.measures_.of_fields.contains(mapping.outer);
    if (mapping.outer->slot < 0 || converted) continue;
    const auto known = sink_.measures_.of_fields.find(mapping.inner);
    const Measure measure = known == sink_.measures_.of_fields.end()
                                ? measure_of(*sink_.scene_.node(mapping.node).type, *mapping.inner)
                                : known->second;
    if (measure == Measure::none) continue;
    sink_.measures_.of_fields.emplace(mapping.outer, measure);
    scale_measures(type.defaults[static_cast<std::size_t>(mapping.outer->slot)], sink_.measures_.units.of(measure));
  }
  for (InterfaceDeclaration& field : type.interfaces)
    if (sink_.measures_.of_fields.contains(&field)) field.initial = type.defaults[static_cast<std::size_t>(field.slot)];
}

void PrototypeSink::end_body() {
  sink_.finish();
  NodeType& type = *sink_.scopes_.back().prototype;
  sink_.scopes_.pop_back();
  sink_.recent_types_.clear();
  type.prototype->complete = true;
  if (!sink_.measures_.units.are_standard()) convert_prototype(type);
  count_instance_nodes(sink_.scene_, *type.prototype);
  // The first node of the body determines where instances may stand (VRML97 4.8.3).
  for (const Statement& statement : type.prototype->statements) {
    if (statement.kind != Statement::Kind::node) continue;
    type.role = sink_.scene_.node(statement.node).type->role;
    break;
  }
  add_type(type);
}

void PrototypeSink::end_external(NodeType& type, MFString url) {
  type.url = std::move(url);
  add_type(type);
}

// Adds a complete declaration: from here on, nodes with its name have this type. Names of types must be unique (4.8).
// But an extension may have a fallback of the same name for other browsers. A declaration inside a node (Annex A.1) is
// printed before that node.
void PrototypeSink::add_type(NodeType& type) {
  const NodeType* const built_in = built_in_node_type(sink_.text_.language(), type.name);
  const SceneSink::Scope& scope = sink_.scopes_.back();
  const NodeType*& known = sink_.scopes_.back().types[type.name];
  const bool taken = known || (built_in && !is_extension(built_in->clause));
  if (taken && sink_.said_types_.insert(type.name).second)
    sink_.problems_.warn(type.location, (known ? '\'' + type.name + "' is already declared"
                                               : '\'' + type.name + "' is a built-in node") +
                                            " (VRML97 4.8); this PROTO is used from here on");
  known = &type;
  sink_.recent_types_.clear();
  std::vector<Statement>& list = sink_.scopes_.back().statements(sink_.text_);
  auto position = list.end();
  if (scope.open_nodes > 0 || sink_.open_interfaces_ > scope.interfaces_around)
    while (position != list.begin() && (--position)->kind != Statement::Kind::node) {
    }
  list.insert(position, {Statement::Kind::prototype, {}, &type, {}});
}

void PrototypeSink::connect(OpenNode& node, SourceName inner_name, SourceName outer_name) {
  if (!sink_.in_prototype_body()) {
    sink_.problems_.error(inner_name.location, "IS outside of a PROTO body");
    return;
  }
  const auto inner_of = [&](const NodeType& type) {
    const InterfaceDeclaration* found = type.find(inner_name.text);
    if (!found) found = type.find_event_in(inner_name.text);
    return found ? found : type.find_event_out(inner_name.text);
  };
  if (!inner_of(*node.type) && sink_.extend(node.id, inner_name)) node.type = sink_.scene_.node(node.id).type;
  const NodeType& type = *node.type;
  const NodeType& prototype = *sink_.scopes_.back().prototype;
  const InterfaceDeclaration* const inner = inner_of(type);
  const InterfaceDeclaration* const outer = prototype.find(outer_name.text);
  if (!inner && (sink_.is_lenient(type) || type.ignored || sink_.take_extension(type, inner_name))) return;
  if (!inner || !outer) {
    sink_.problems_.error(inner ? outer_name.location : inner_name.location,
                          inner ? "PROTO " + prototype.name + " has no " + quoted(outer_name.text)
                                : type.name + " has no " + quoted(inner_name.text));
    return;
  }
  const auto mapping = [&](std::string_view of_inner, std::string_view of_outer) {
    return std::string(of_inner) + " " + quoted(inner_name.text) + " IS " + std::string(of_outer) + " " +
           quoted(outer_name.text);
  };
  if (inner->type != outer->type) {
    sink_.problems_.error(inner_name.location,
                          mapping(name_of(inner->type), name_of(outer->type)) + "; expected equal types");
    return;
  }
  if (!may_be_mapped(inner->access, outer->access))
    sink_.problems_.warn(
        inner_name.location,
        mapping(name_of(inner->access, sink_.text_.language()), name_of(outer->access, sink_.text_.language())) +
            (sink_.text_.language() == Language::x3d ? " (ISO/IEC 19775-1 Table 4.4)" : " (VRML97 Table 4.4)"));
  prototype.prototype->mappings.push_back({node.id, inner, outer});
}

}  // namespace gs::vrml
