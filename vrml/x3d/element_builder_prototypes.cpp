#include "vrml/x3d/element_builder.h"

#include "base/text.h"
#include "vrml/syntax/numbers/number.h"

#include <optional>
#include <utility>

// Statements, PROTO, EXTERNPROTO, their instances and IS.
namespace gs::vrml::x3d {
namespace {

std::optional<AccessType> access_named(std::string_view word) {
  static constexpr std::pair<std::string_view, AccessType> kNames[] = {
      {"initializeOnly", AccessType::field}, {"inputOutput", AccessType::exposedField},
      {"inputOnly", AccessType::eventIn},    {"outputOnly", AccessType::eventOut},
      {"field", AccessType::field},          {"exposedField", AccessType::exposedField},
      {"eventIn", AccessType::eventIn},      {"eventOut", AccessType::eventOut}};
  return value_named(kNames, word);
}

}  // namespace

void ElementBuilder::begin_statement(SourceName element, std::span<const Attribute> attributes, Frame& frame) {
  const auto value = [&](std::string_view name) { return value_in(attributes, name); };
  const auto first = [&](std::string_view name, std::string_view other) {
    return value(name).empty() ? value(other) : value(name);
  };
  const auto named = [&](std::string_view text) { return SourceName{text, element.location}; };
  X3DStatementSink& statements = sink_.statements();
  switch (frame.kind) {
    case ElementKind::route:
      return sink_.routes().add({std::string(value("fromNode")), std::string(value("fromField")),
                                 std::string(value("toNode")), std::string(value("toField")), element.location});
    case ElementKind::x3d: {
      double version = 0;
      if (parse_number(value("version"), version) && version >= 3 && version < 10)
        statements.set_version(static_cast<int>(version * 10 + 0.5), element.location);
      if (!value("profile").empty()) statements.set_profile(named(value("profile")));
      return;
    }
    case ElementKind::component: {
      std::int32_t level = 1;
      (void)parse_number(value("level"), level);
      return statements.add_component(named(value("name")), level);
    }
    case ElementKind::meta:
      // Elements in web pages may lack the name.
      return statements.add_meta(first("name", "http-equiv"), value("content"), element.location);
    case ElementKind::unit: {
      double factor = 0;
      if (!parse_number(value("conversionFactor"), factor))
        return sink_.problems().error(element.location, "expected a number as conversionFactor of a unit, found " +
                                                            quoted(value("conversionFactor")));
      return statements.set_unit(named(value("category")), value("name"), factor);
    }
    case ElementKind::import_node:
      // The attribute of X3D 3.0 is exportedDEF.
      return statements.import_node(named(value("inlineDEF")), first("importedDEF", "exportedDEF"), value("AS"));
    case ElementKind::export_node:
      return statements.export_node(named(value("localDEF")), value("AS"));
    default:
      return;
  }
}

// Begins an element of a PROTO, of an EXTERNPROTO, or of an interface.
void ElementBuilder::begin_prototype(SourceName element, std::span<const Attribute> attributes, Frame& frame) {
  Frame* const parent = this->parent();
  switch (frame.kind) {
    case ElementKind::prototype:
    case ElementKind::external_prototype: {
      const std::string_view name = value_in(attributes, "name");
      if (name.empty()) {
        frame.skipped = true;
        return sink_.problems().error(element.location,
                                      "the element " + quoted(element.text) + " has no name; skipped");
      }
      const bool external = frame.kind == ElementKind::external_prototype;
      frame.declaring = &sink_.prototypes().begin_prototype({name, element.location}, external);
      frame.interface_open = true;
      if (external) {
        frame.pending = std::make_unique<InterfaceDeclaration>();
        frame.pending->initial = MFString{};
      }
      return;
    }
    case ElementKind::prototype_interface:
      if (!parent || parent->kind != ElementKind::prototype || !parent->interface_open)
        return skip_misplaced(element, frame);
      frame.declaring = parent->declaring;
      return;
    case ElementKind::prototype_body:
      if (!parent || parent->kind != ElementKind::prototype || !parent->interface_open)
        return skip_misplaced(element, frame);
      sink_.prototypes().end_interface();
      parent->interface_open = false;
      return sink_.prototypes().begin_body(*parent->declaring);
    case ElementKind::field:
      return begin_field(element, attributes, frame);
    case ElementKind::field_value:
      return begin_field_value(element, attributes, frame);
    case ElementKind::is:
      if (!parent || !parent->node.id) skip_misplaced(element, frame);
      return;
    default:
      return connect(element, attributes, frame);
  }
}

void ElementBuilder::begin_field(SourceName element, std::span<const Attribute> attributes, Frame& frame) {
  const Frame* const parent = this->parent();
  const bool is_open = parent && (parent->kind != ElementKind::prototype || parent->interface_open);
  frame.skipped = parent && parent->node.id && parent->node.type->ignored && !parent->declaring;
  if (frame.skipped) return;
  if (!is_open || !parent->declaring || parent->kind == ElementKind::field) return skip_misplaced(element, frame);
  const std::string_view name = value_in(attributes, "name"), type = value_in(attributes, "type"),
                         access = value_in(attributes, "accessType");
  const auto field_type = field_type_named(type);
  const auto access_type = access_named(access);
  if (name.empty() || !field_type || !access_type) {
    frame.skipped = true;
    return sink_.problems().error(
        element.location,
        name.empty()  ? "a field has no name; skipped"
        : !field_type ? "the field " + quoted(name) + " has the unknown type " + quoted(type) + "; skipped"
                      : "the field " + quoted(name) + " has the unknown accessType " + quoted(access) + "; skipped");
  }
  frame.declaring = parent->declaring;
  frame.owner = parent->node.id;
  frame.pending = std::make_unique<InterfaceDeclaration>();
  frame.pending->name = name;
  frame.pending->type = *field_type;
  frame.pending->access = *access_type;
  if (*access_type == AccessType::field || *access_type == AccessType::exposedField)
    frame.pending->initial = initial_value(*field_type);
}

void ElementBuilder::end_field(Frame& frame) {
  if (sink_.prototypes().may_declare(*frame.declaring, *frame.pending, frame.location))
    sink_.prototypes().declare(*frame.declaring, frame.owner, std::move(*frame.pending));
}

void ElementBuilder::begin_field_value(SourceName element, std::span<const Attribute> attributes, Frame& frame) {
  Frame* const parent = this->parent();
  if (!parent || !parent->node.id || parent->kind == ElementKind::field) return skip_misplaced(element, frame);
  const std::string_view name = value_in(attributes, "name");
  if (name.empty())
    sink_.problems().error(element.location, "a fieldValue has no name; skipped");
  else
    frame.field = sink_.find_field(parent->node, {name, element.location});
  frame.skipped = !frame.field;
  if (!frame.field || !holds_nodes(frame.field->type)) return;
  // A fieldValue without nodes means no nodes, instead of the default value.
  if (frame.field->type == FieldType::MFNode)
    (void)target_in(frames_.back(), *frame.field, element);
  else
    *sink_.target_of(parent->node, *frame.field).value = SFNode{};
}

void ElementBuilder::connect(SourceName element, std::span<const Attribute> attributes, Frame& frame) {
  Frame* const node = frames_.size() < 2 ? nullptr : &frames_[frames_.size() - 2];
  if (!node || frames_.back().kind != ElementKind::is) return skip_misplaced(element, frame);
  const std::string_view inner = value_in(attributes, "nodeField"), outer = value_in(attributes, "protoField");
  // The interfaces of a Script may follow its IS element.
  if (node->node.own_type && !node->node.type->find(inner)) {
    if (!node->script) node->script = std::make_unique<ScriptParts>();
    (void)sink_.scene().memory().charge(sizeof(Connection) + inner.size() + outer.size());
    node->script->connections.push_back({std::string(inner), std::string(outer), element.location});
    return;
  }
  sink_.prototypes().connect(node->node, {inner, element.location}, {outer, element.location});
}

void ElementBuilder::end_prototype(Frame& frame) {
  if (frame.interface_open) sink_.prototypes().end_interface();
  if (frame.kind == ElementKind::external_prototype)
    return sink_.prototypes().end_external(*frame.declaring,
                                           std::move(*std::get_if<MFString>(&frame.pending->initial)));
  if (!frame.interface_open) return;
  sink_.prototypes().begin_body(*frame.declaring);
  sink_.prototypes().end_body();
}

}  // namespace gs::vrml::x3d
