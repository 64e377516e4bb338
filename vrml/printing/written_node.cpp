#include "vrml/printing/written_node.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::string_view kX3DScheme = "ecmascript:", kVrml97Scheme = "javascript:";
constexpr std::array<std::string_view, 3> kScriptSchemes{kX3DScheme, kVrml97Scheme, "vrmlscript:"};

std::string_view language_name(Language language) { return language == Language::x3d ? "X3D" : "VRML97"; }

bool has_prefix(std::string_view text, std::string_view lower_case) {
  return text.size() >= lower_case.size() &&
         std::equal(lower_case.begin(), lower_case.end(), text.begin(),
                    [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? static_cast<char>(b - 'A' + 'a') : b); });
}

// Returns the scheme of a URL that contains a program; empty for other URLs.
std::string_view program_scheme(std::string_view url) {
  const auto found = std::find_if(kScriptSchemes.begin(), kScriptSchemes.end(),
                                  [&](std::string_view each) { return has_prefix(url, each); });
  return found == kScriptSchemes.end() ? std::string_view{} : *found;
}

// Returns the programs of a Script with the URL scheme of the language (ISO/IEC 19777-1 4.1; VRML97 C.2.1), or nullopt
// if they have it.
std::optional<MFString> with_scheme(const MFString& urls, std::string_view scheme) {
  std::optional<MFString> changed;
  for (std::size_t i = 0; i < urls.size(); ++i) {
    const std::string_view url = urls[i].view();
    const std::string_view old = program_scheme(url);
    if (old.empty() || url.starts_with(scheme)) continue;
    if (!changed) changed = urls;
    changed->mutable_data()[i] = std::string(scheme) + std::string(url.substr(old.size()));
  }
  return changed;
}

// Reports whether a built-in type is a private copy for one node, which the node's declarations extend.
bool is_own_type(const NodeType& type) {
  const NodeType* const x3d = built_in_node_type(Language::x3d, type.name);
  return type.kind == NodeType::Kind::built_in && x3d && x3d != &type && built_in_node_type(type.name) != &type;
}

bool is_url_field(const NodeType& type, const InterfaceDeclaration& declaration) {
  const auto fields = type.url_fields();
  return std::find(fields.begin(), fields.end(), &declaration) != fields.end();
}

}  // namespace

bool is_program_url(std::string_view url) { return !program_scheme(url).empty(); }

const NodeTranslator::Plan& NodeTranslator::plan(const NodeType& type) {
  const auto found = plans_.find(&type);
  return found != plans_.end() ? found->second : plans_.emplace(&type, made_plan(type)).first->second;
}

NodeTranslator::Plan NodeTranslator::made_plan(const NodeType& type) const {
  Plan made;
  made.type = &type;
  if (type.kind == NodeType::Kind::script) {
    add_script_pairs(type, made);
    return made;
  }
  if (is_own_type(type)) {
    add_own_pairs(type, made);
    return made;
  }
  if (type.stands_in && language_ == Language::x3d) {
    // VRML97 has a stand-in for some nodes of X3D.
    const NodeType* const native = built_in_node_type(language_, type.name);
    if (native && native->language == Language::x3d) made.type = native;
  }
  if (type.kind == NodeType::Kind::built_in && type.language != language_) {
    made.type = built_in_node_type(language_, type.name);
    if (!made.type && language_ == Language::vrml97 && type.equivalent) {
      made.equivalent = type.equivalent;
      made.type = built_in_node_type(type.equivalent->type);
    }
    if (!made.type) return made;
  }
  for (const InterfaceDeclaration& to : made.type->interfaces)
    if (const InterfaceDeclaration* const from = &type == made.type ? &to : type.find(to.name);
        from && from->type == to.type && (from->slot >= 0) == (to.slot >= 0))
      made.pairs.push_back({from, &to, is_url_field(type, *from)});
  for (const InterfaceDeclaration& from : type.interfaces)
    if (std::none_of(made.pairs.begin(), made.pairs.end(), [&](const Pair& pair) { return pair.from == &from; }))
      made.lost.push_back(&from);
  return made;
}

// The private type of a Script has the interfaces of the built-in Script of its language first.
void NodeTranslator::add_script_pairs(const NodeType& type, Plan& made) const {
  const NodeType& vrml97 = built_in_node_type(NodeKind::script);
  const NodeType& x3d = *built_in_node_type(Language::x3d, vrml97.name);
  const NodeType& plain = language_ == Language::x3d ? x3d : vrml97;
  const bool of_x3d = std::equal(
      x3d.interfaces.begin(), x3d.interfaces.end(), type.interfaces.begin(),
      type.interfaces.begin() + static_cast<std::ptrdiff_t>(std::min(x3d.interfaces.size(), type.interfaces.size())),
      [](const auto& a, const auto& b) { return a.name == b.name; });
  const std::size_t own = (of_x3d ? x3d : vrml97).interfaces.size();
  for (std::size_t i = 0; i < type.interfaces.size(); ++i) {
    const InterfaceDeclaration& each = type.interfaces[i];
    // A name that a VRML97 Script declares may be that of a field of all X3D Scripts.
    const InterfaceDeclaration* const standard = i < own ? nullptr : plain.find(each.name);
    if (standard && standard->type == each.type && (standard->slot >= 0) == (each.slot >= 0))
      made.pairs.push_back({&each, standard, is_url_field(type, each), false, true});
    else if (standard || (i < own && !plain.find(each.name)))
      made.lost.push_back(&each);
    else
      made.pairs.push_back({&each, &each, is_url_field(type, each), i >= own});
  }
  // Fields of all Scripts come first, in their order.
  const auto place = [&](const Pair& pair) {
    const auto found = std::find_if(plain.interfaces.begin(), plain.interfaces.end(),
                                    [&](const InterfaceDeclaration& each) { return each.name == pair.to->name; });
    return pair.declares ? plain.interfaces.end() : found;
  };
  std::stable_sort(made.pairs.begin(), made.pairs.end(),
                   [&](const Pair& a, const Pair& b) { return place(a) < place(b); });
}

// The private type of a shader has the interfaces of the built-in type first. VRML97 has no shaders.
void NodeTranslator::add_own_pairs(const NodeType& type, Plan& made) const {
  if (language_ == Language::vrml97) {
    made.type = nullptr;
    return;
  }
  const std::size_t standard = built_in_node_type(language_, type.name)->interfaces.size();
  for (std::size_t i = 0; i < type.interfaces.size(); ++i)
    made.pairs.push_back(
        {&type.interfaces[i], &type.interfaces[i], is_url_field(type, type.interfaces[i]), i >= standard});
}

std::string_view NodeTranslator::written_name(const NodeType& type, const InterfaceDeclaration& declaration) {
  for (const Pair& pair : plan(type).pairs)
    if (pair.from == &declaration) return name_in(language_, *pair.to);
  return {};
}

std::optional<MFString> NodeTranslator::moved_default(const NodeType& type,
                                                      const InterfaceDeclaration& declaration) const {
  const auto* const urls = std::get_if<MFString>(&declaration.initial);
  return moved_urls_ && urls && is_url_field(type, declaration) ? moved_urls_(*urls) : std::nullopt;
}

void NodeTranslator::add_left_out(const NodeType& type) {
  losses_.add(type.name + " is left out: " + std::string(language_name(language_)) + " has no such node");
}

bool NodeTranslator::holds_written_node(const SceneGraph& scene, const FieldValue& value) {
  if (const auto* one = std::get_if<SFNode>(&value)) return !scene.contains(*one) || is_written(scene, *one);
  const auto* many = std::get_if<MFNode>(&value);
  return !many || many->empty() ||
         std::any_of(many->begin(), many->end(), [&](NodeId id) { return is_written(scene, id); });
}

const FieldValue& NodeTranslator::written_value(const Node& node, const Pair& pair, WrittenNode& written) const {
  const FieldValue& value = node.values[pair.from->slot];
  if (!pair.is_url) return value;
  const auto& urls = std::get<MFString>(value);
  std::optional<MFString> changed = moved_urls(urls);
  if (node.type->kind == NodeType::Kind::script)
    if (auto renamed = with_scheme(changed ? *changed : urls, language_ == Language::x3d ? kX3DScheme : kVrml97Scheme);
        renamed && node.text->language() != language_)
      changed = std::move(renamed);
  return changed ? written.changed.emplace_back(std::move(*changed)) : value;
}

void NodeTranslator::report_lost_fields(const Node& node, const Plan& plan) {
  for (const InterfaceDeclaration* const lost : plan.lost)
    if (lost->slot >= 0 && node.values[lost->slot] != node.type->defaults[lost->slot])
      losses_.add("the field " + name_in(node.type->language, *lost) + " of " + node.type->name +
                  " is left out: " + std::string(language_name(language_)) + " lacks it");
}

WrittenNode NodeTranslator::written(const SceneGraph& scene, NodeId id, const IsMappings* mappings) {
  const Node& node = scene.node(id);
  const Plan& plan = this->plan(*node.type);
  if (plan.equivalent && !plan.equivalent->loss.empty()) losses_.add(std::string(plan.equivalent->loss));
  if (plan.equivalent && plan.equivalent->make) {
    auto made = std::make_shared<MadeNode>(plan.equivalent->make(scene, id, *plan.type));
    WrittenNode written = NodeTranslator::written(*made);
    std::erase_if(written.fields,
                  [&](const WrittenField& field) { return field.value && !holds_written_node(scene, *field.value); });
    written.made = std::move(made);
    return written;
  }
  WrittenNode written;
  written.type = plan.type;
  for (const Pair& pair : plan.pairs) {
    WrittenField field{pair.to, name_in(language_, *pair.to)};
    field.declares = pair.declares;
    if (mappings)
      for (const IsMapping* const mapping : *mappings)
        if (mapping->inner == pair.from) field.is = mapping->outer->name;
    if (field.is.empty() && pair.from->slot >= 0) {
      const FieldValue& value = node.values[pair.from->slot];
      const FieldValue& usual = pair.is_standard ? pair.to->initial : plan.type->defaults[pair.to->slot];
      const bool given = pair.declares || value != usual;
      if (!given || (!pair.declares && !holds_written_node(scene, value))) continue;
      field.value = &written_value(node, pair, written);
    }
    if (field.declares || field.value || !field.is.empty()) written.fields.push_back(field);
  }
  if (!plan.lost.empty()) report_lost_fields(node, plan);
  return written;
}

WrittenNode NodeTranslator::written(const MadeNode& made) {
  WrittenNode written;
  written.type = &made.type;
  for (const InterfaceDeclaration& declaration : made.type.interfaces)
    for (const MadeNode::Field& each : made.fields) {
      if (each.declaration != &declaration) continue;
      if (!each.node && each.value == made.type.defaults[declaration.slot]) continue;
      written.fields.push_back({&declaration, declaration.name, each.node ? nullptr : &each.value, each.node.get()});
    }
  return written;
}

}  // namespace gs::vrml
