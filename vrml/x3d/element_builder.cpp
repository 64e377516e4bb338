#include "vrml/x3d/element_builder.h"

#include "vrml/syntax/tokens/name_map.h"

#include <algorithm>
#include <utility>

// Elements, nodes and their attributes. The other parts are in element_builder_prototypes.cpp.
namespace gs::vrml::x3d {
namespace {

constexpr int kLatestVersion = 40;  // of texts that state none

}  // namespace

ElementKind kind_of(std::string_view element) {
  static constexpr NameMap kKinds({
      std::pair<std::string_view, ElementKind>{"X3D", ElementKind::x3d},
      {"Scene", ElementKind::scene},
      {"ROUTE", ElementKind::route},
      {"field", ElementKind::field},
      {"fieldValue", ElementKind::field_value},
      {"IS", ElementKind::is},
      {"connect", ElementKind::connect},
      {"ProtoInstance", ElementKind::instance},
      {"ProtoDeclare", ElementKind::prototype},
      {"ProtoInterface", ElementKind::prototype_interface},
      {"ProtoBody", ElementKind::prototype_body},
      {"ExternProtoDeclare", ElementKind::external_prototype},
      {"head", ElementKind::head},
      {"Header", ElementKind::head},
      {"component", ElementKind::component},
      {"meta", ElementKind::meta},
      {"unit", ElementKind::unit},
      {"IMPORT", ElementKind::import_node},
      {"EXPORT", ElementKind::export_node},
      {"X3d", ElementKind::x3d},
      {"x3d", ElementKind::x3d},
      {"scene", ElementKind::scene},
  });
  return kKinds.find(element, ElementKind::node);
}

ElementBuilder::ElementBuilder(SceneSink& sink) : sink_(sink) {
  sink.scene().texts().writing().set_language(Language::x3d, kLatestVersion);
}

std::string_view ElementBuilder::value_in(std::span<const Attribute> attributes, std::string_view name) {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&](const Attribute& attribute) { return attribute.name == name; });
  return found == attributes.end() ? std::string_view{} : found->value;
}

void ElementBuilder::begin(SourceName element, std::span<const Attribute> attributes) {
  Frame frame;
  frame.kind = kind_of(element.text);
  frame.location = element.location;
  const bool skipped = !frames_.empty() && frames_.back().skipped;
  const bool too_deep = !sink_.limits().admits_depth(frames_.size(), element.location);
  switch (frame.kind) {
    case ElementKind::x3d:
    case ElementKind::scene:
      is_x3d_ = true;
      [[fallthrough]];
    case ElementKind::head:
    case ElementKind::component:
    case ElementKind::meta:
    case ElementKind::unit:
    case ElementKind::route:
    case ElementKind::import_node:
    case ElementKind::export_node:
      begin_statement(element, attributes, frame);
      break;
    case ElementKind::node:
    case ElementKind::instance:
      frame.skipped = too_deep;
      if (!too_deep) begin_node(element, attributes, frame);
      break;
    default:
      frame.skipped = skipped || too_deep;
      if (!frame.skipped) begin_prototype(element, attributes, frame);
      break;
  }
  frames_.push_back(std::move(frame));
}

void ElementBuilder::skip_misplaced(SourceName element, Frame& frame) {
  constexpr std::size_t kMaxNames = 1000;
  frame.skipped = true;
  const std::string name(element.text.substr(0, 64));
  if (said_.size() < kMaxNames && said_.insert(name).second)
    sink_.problems().error(element.location, "the element " + quoted(name) + " has no place here; skipped");
}

NodeTarget ElementBuilder::target_in(Frame& parent, const InterfaceDeclaration& field, SourceName element) {
  const NodeTarget target = sink_.target_of(parent.node, field);
  const bool given = field.slot < 64 && (parent.node.fields_given >> field.slot & 1) != 0;
  if (field.type == FieldType::MFNode && given) return target;
  *target.value = initial_value(field.type);
  sink_.field_given(parent.node, field, {field.name, element.location});
  return target;
}

// Finds the destination of a node in the innermost element. Returns false if the element takes no such node.
bool ElementBuilder::find_target(const NodeType* type, SourceName element, std::string_view container,
                                 NodeTarget& target) {
  target = {};
  if (frames_.empty()) return true;
  Frame& parent = frames_.back();
  if (parent.skipped) return false;
  switch (parent.kind) {
    case ElementKind::x3d:
    case ElementKind::scene:
    case ElementKind::prototype_body:
      return true;
    case ElementKind::field:
      if (!holds_nodes(parent.pending->type) || parent.pending->initial.index() != std::size_t(parent.pending->type))
        return false;
      target.value = &parent.pending->initial;
      return true;
    case ElementKind::field_value:
      if (!parent.field || !holds_nodes(parent.field->type)) return false;
      target = target_in(frames_[frames_.size() - 2], *parent.field, element);
      return true;
    case ElementKind::node:
    case ElementKind::instance: {
      const InterfaceDeclaration* const field = places_.find(*parent.node.type, type, container);
      if (field) target = target_in(parent, *field, element);
      return field != nullptr;
    }
    default:
      return false;
  }
}

void ElementBuilder::begin_node(SourceName element, std::span<const Attribute> attributes, Frame& frame) {
  const std::string_view use = value_in(attributes, "USE"), container = value_in(attributes, "containerField");
  std::string_view name = value_in(attributes, "DEF");
  SourceName type_name = element;
  if (frame.kind == ElementKind::instance) type_name.text = value_in(attributes, "name");
  const bool in_skipped = !frames_.empty() && (frames_.back().skipped || frames_.back().kind == ElementKind::head);
  frame.skipped = true;
  // Reads a named node instead of skipping it, because a later USE may refer to it.
  if (in_skipped && (name.empty() || !sink_.find_type(type_name.text))) return;
  const NodeType* type = type_name.text.empty() ? nullptr : sink_.find_type(type_name.text);
  if (type_name.text.empty() && use.empty()) {
    sink_.problems().error(element.location, "a ProtoInstance has no name; skipped");
    return;
  }
  if (!type && use.empty() && element.text.front() >= 'a' && element.text.front() <= 'z' &&
      frame.kind == ElementKind::node) {
    if (said_.size() < 1000 && said_.insert(std::string(element.text.substr(0, 64))).second)
      sink_.problems().warn(element.location, "unknown element " + quoted(element.text) + "; skipped with its content");
    return;
  }
  if (!type && use.empty()) type = sink_.find_stand_in(type_name);
  NodeTarget target;
  // An unknown node must not replace a node in its field.
  const bool placed = (type || !use.empty()) && find_target(type, element, container, target);
  if (!use.empty()) {
    if (placed) sink_.use_node({use, element.location}, target);
    return;
  }
  if (!placed) {
    discarded_ = MFNode{};
    target = {&discarded_, {}};
    if (!in_skipped && type && type->bases.find("X3DMetadataObject") == std::string::npos)
      sink_.problems().error(element.location, quoted(type->name) + " has no place here; not shown");
  }
  frame.node = sink_.begin_node({type_name, name, target, frames_.size()});
  frame.skipped = !frame.node.id;
  frame.declaring = frame.node.own_type;
}

void ElementBuilder::name_node(SourceName name) {
  if (!frames_.empty() && frames_.back().node.id) sink_.name_node(frames_.back().node, name);
}

// Returns the field of an attribute. Files contain attributes of pages and of other browsers, which get one warning
// each.
const InterfaceDeclaration* ElementBuilder::find_field(Frame& frame, SourceName attribute) {
  constexpr std::size_t kMaxNames = 1000;
  const NodeType& type = *frame.node.type;
  const InterfaceDeclaration* const field = type.find_field(attribute.text);
  if (field || type.ignored || type.stands_in) return field;
  if (type.find_event_in(attribute.text) || type.find_event_out(attribute.text))
    return sink_.find_field(frame.node, attribute);
  const std::string name = type.name + ' ' + std::string(attribute.text.substr(0, 64));
  if (said_.size() < kMaxNames && said_.insert(name).second)
    sink_.problems().warn(attribute.location, type.name + " has no field " + quoted(attribute.text) + "; ignored");
  return nullptr;
}

namespace {

// Returns the name of a field that equals `text`. It lives as long as the field, while `text` may end with its piece.
std::string_view own_name(const InterfaceDeclaration& field, std::string_view text) {
  for (const std::string* name : {&field.x3d_name, &field.former_name})
    if (*name == text) return *name;
  return field.name;
}

}  // namespace

FieldValue* ElementBuilder::value_of(SourceName attribute) {
  given_ = nullptr;
  if (frames_.empty() || frames_.back().skipped) return nullptr;
  Frame& frame = frames_.back();
  given_name_ = attribute;
  const auto without_nodes = [](FieldValue* value) { return holds_nodes(type_of(*value)) ? nullptr : value; };
  switch (frame.kind) {
    case ElementKind::external_prototype:
      return attribute.text == "url" ? &frame.pending->initial : nullptr;
    case ElementKind::field:
      if (attribute.text != "value" || frame.declaring->kind == NodeType::Kind::external_prototype ||
          frame.pending->access == AccessType::eventIn || frame.pending->access == AccessType::eventOut)
        return nullptr;
      return without_nodes(&frame.pending->initial);
    case ElementKind::field_value:
      if (attribute.text != "value" || !frame.field) return nullptr;
      given_ = frame.field;
      given_name_.text = "value";
      return without_nodes(sink_.target_of(frames_[frames_.size() - 2].node, *frame.field).value);
    case ElementKind::node:
      break;
    default:
      return nullptr;
  }
  enum class Meaning : std::uint8_t { field, of_element, of_pages };
  static constexpr NameMap kMeanings({std::pair<std::string_view, Meaning>{"DEF", Meaning::of_element},
                                      {"USE", Meaning::of_element},
                                      {"containerField", Meaning::of_element},
                                      {"class", Meaning::of_pages},
                                      {"id", Meaning::of_pages},
                                      {"style", Meaning::of_pages},
                                      {"xmlns", Meaning::of_pages}});
  const Meaning meaning = kMeanings.find(attribute.text, Meaning::field);
  if (meaning == Meaning::of_element || attribute.text.find(':') != std::string_view::npos) return nullptr;
  if (meaning == Meaning::of_pages && !frame.node.type->find_field(attribute.text)) return nullptr;
  given_ = find_field(frame, attribute);
  if (given_) given_name_.text = own_name(*given_, attribute.text);
  return given_ ? without_nodes(sink_.target_of(frame.node, *given_).value) : nullptr;
}

void ElementBuilder::value_given() {
  if (!given_) return;
  Frame& frame = frames_.back().kind == ElementKind::field_value ? frames_[frames_.size() - 2] : frames_.back();
  sink_.field_given(frame.node, *given_, given_name_);
  if (frame.node.own_type && given_->name == "url")
    frame.node.own_type->url_places.resize(element_count(sink_.scene().node(frame.node.id).values[given_->slot]),
                                           given_name_.location);
}

bool ElementBuilder::takes_text() const {
  if (frames_.empty() || !frames_.back().node.id || frames_.back().kind != ElementKind::node) return false;
  const InterfaceDeclaration* const url = frames_.back().node.type->find_field("url");
  return url && url->type == FieldType::MFString;
}

void ElementBuilder::text(std::string_view text, SourceLocation location) {
  Frame& frame = frames_.back();
  if (!frame.script || frame.script->text.empty()) {
    const std::size_t blanks = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    location = location_in(text, location, text.data() + blanks);
    text.remove_prefix(blanks);
    if (text.empty()) return;
    if (!frame.script) frame.script = std::make_unique<ScriptParts>();
    frame.script->text_location = location;
  }
  const std::size_t size = frame.script->text.size() + text.size();
  if (size > sink_.scene().limits().string_bytes || !sink_.scene().memory().charge(text.size())) return;
  frame.script->text += text;
}

// Adds the program in an element to the node's url.
void ElementBuilder::add_text_url(Frame& frame) {
  std::string_view text = frame.script->text;
  text = text.substr(0, text.find_last_not_of(" \t\r\n") + 1);
  const InterfaceDeclaration* const url = frame.node.type->find_field("url");
  if (text.empty() || !url || url->type != FieldType::MFString) return;
  auto& list = *std::get_if<MFString>(sink_.target_of(frame.node, *url).value);
  const bool given = url->slot < 64 && (frame.node.fields_given >> url->slot & 1) != 0;
  if (!given) list.clear();
  list.push_back(String(text));
  if (!given) sink_.field_given(frame.node, *url, {url->name, frame.script->text_location});
  if (frame.node.own_type) frame.node.own_type->url_places.push_back(frame.script->text_location);
}

void ElementBuilder::end_node(Frame& frame) {
  if (frame.script) {
    add_text_url(frame);
    for (const Connection& one : frame.script->connections)
      sink_.prototypes().connect(frame.node, {one.inner, one.location}, {one.outer, one.location});
  }
  sink_.end_node(frame.node.id);
}

void ElementBuilder::end() {
  if (frames_.empty()) return;
  Frame frame = std::move(frames_.back());
  frames_.pop_back();
  if (frame.skipped) return;
  switch (frame.kind) {
    case ElementKind::node:
    case ElementKind::instance:
      return end_node(frame);
    case ElementKind::field:
      return end_field(frame);
    case ElementKind::prototype:
    case ElementKind::external_prototype:
      return end_prototype(frame);
    case ElementKind::prototype_body:
      return sink_.prototypes().end_body();
    default:
      return;
  }
}

void ElementBuilder::finish() {
  while (!frames_.empty()) end();
  sink_.finish();
}

SourceLocation ElementBuilder::open_location() const {
  return frames_.empty() ? SourceLocation{} : frames_.back().location;
}

std::vector<NodeId> ElementBuilder::open_nodes() const {
  std::vector<NodeId> nodes;
  for (const Frame& frame : frames_)
    if (frame.node.id) nodes.push_back(frame.node.id);
  return nodes;
}

}  // namespace gs::vrml::x3d
