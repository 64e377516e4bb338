#include "vrml/printing/text_head.h"

#include "vrml/printing/written_node.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <utility>
#include <variant>
#include <vector>

namespace gs::vrml {
namespace {

/// Profile with its components and their levels.
struct Profile {
  std::string_view name;
  std::string_view components;  // "NAME:LEVEL" each followed by a blank
};

// Tables B.1, D.1 and E.1 of ISO/IEC 19775-1, the smallest profile first.
constexpr Profile kWrittenProfiles[] = {
    {"Interchange",
     "Core:1 EnvironmentalEffects:1 Geometry3D:2 Grouping:1 Interpolation:2 Lighting:1 Navigation:1 Networking:1 "
     "Rendering:3 Shape:1 Texturing:2 Time:1 "},
    {"Interactive",
     "Core:1 EnvironmentalEffects:1 EnvironmentalSensor:1 EventUtilities:1 Geometry3D:3 Grouping:2 Interpolation:2 "
     "KeyDeviceSensor:1 Lighting:2 Navigation:1 Networking:2 PointingDeviceSensor:1 Rendering:3 Shape:1 Texturing:2 "
     "Time:1 "},
    {"Immersive",
     "Core:2 EnvironmentalEffects:2 EnvironmentalSensor:2 EventUtilities:1 Geometry2D:1 Geometry3D:4 Grouping:2 "
     "Interpolation:2 KeyDeviceSensor:2 Lighting:2 Navigation:2 Networking:3 PointingDeviceSensor:1 Rendering:3 "
     "Scripting:1 Shape:2 Sound:1 Text:1 Texturing:3 Time:1 "},
};

constexpr int kFirstX3DVersion = 33;
constexpr std::string_view kLength = "length";

using Levels = std::map<std::string, int, std::less<>>;

// Returns the level of a component in a profile; 0 if the profile lacks it.
int level_in(const Profile& profile, std::string_view component) {
  std::string_view left = profile.components;
  while (!left.empty()) {
    const std::string_view one = left.substr(0, left.find(' '));
    if (one.size() == component.size() + 2 && one.starts_with(component)) return one.back() - '0';
    left.remove_prefix(one.size() + 1);
  }
  return 0;
}

void raise(Levels& levels, std::string_view component, int level) {
  if (component.empty()) return;
  int& known = levels[std::string(component)];
  known = std::max(known, level);
}

/// Walk over the nodes of a file and of its PROTOs that collects the levels of their components.
class LevelCollector {
 public:
  LevelCollector(const SceneGraph& scene, NodeTranslator& translator)
      : scene_(scene), translator_(translator), seen_(scene.nodes().count() + 1) {}

  [[nodiscard]] Levels collect() {
    add(scene_.statements());
    if (!scene_.x3d().imports.empty() || !scene_.x3d().exports.empty()) raise(levels_, "Networking", 3);
    return std::move(levels_);
  }

 private:
  void add(const std::vector<Statement>& statements) {
    for (const Statement& statement : statements) {
      if (statement.kind == Statement::Kind::node) add(statement.node);
      if (statement.kind != Statement::Kind::prototype) continue;
      add_type(*statement.type);
      for (const InterfaceDeclaration& declaration : statement.type->interfaces) add(declaration.initial);
      const auto& prototype = statement.type->prototype;
      if (prototype && prototype->scene == &scene_) add(prototype->statements);
    }
    while (!waiting_.empty()) {
      const NodeId id = waiting_.back();
      waiting_.pop_back();
      const Node& node = scene_.node(id);
      if (node.type != last_type_) add_type(*node.type);
      last_type_ = node.type;
      for (std::size_t i = 0; i < node.type->defaults.size(); ++i) add(node.values[i]);
    }
  }
  void add(NodeId id) {
    if (!scene_.contains(id) || seen_[id.index]) return;
    seen_[id.index] = true;
    waiting_.push_back(id);
  }
  void add(const FieldValue& value) {
    if (const auto* one = std::get_if<SFNode>(&value)) add(*one);
    if (const auto* many = std::get_if<MFNode>(&value))
      for (const NodeId each : *many) add(each);
  }
  void add_type(const NodeType& type) {
    const NodeType* const written = translator_.written_type(type);
    if (!written) return;
    // The private type of a shader does not state its component.
    const NodeType* const native = built_in_node_type(Language::x3d, written->name);
    if (written->kind == NodeType::Kind::built_in && native)
      raise(levels_, native->component, native->level);
    else if (written->kind == NodeType::Kind::script)
      raise(levels_, "Scripting", 1);
    else if (!written->stands_in)
      raise(levels_, "Core", 2);
  }

  const SceneGraph& scene_;
  NodeTranslator& translator_;
  std::vector<bool> seen_;  // by index
  std::vector<NodeId> waiting_;
  Levels levels_;
  const NodeType* last_type_ = nullptr;
};

}  // namespace

TextHead text_head(const SceneGraph& scene, Grammar grammar, NodeTranslator& translator) {
  TextHead head{grammar};
  const X3DStatements& statements = scene.x3d();
  if (translator.language() == Language::vrml97) {
    for (const X3DStatements::Meta& meta : statements.metas) translator.add_loss("META " + meta.name + " is left out");
    for (const X3DStatements::Unit& unit : statements.units)
      if (unit.category == kLength) translator.add_loss("UNIT " + unit.category + ' ' + unit.name + " is left out");
    return head;
  }
  head.metas = statements.metas;
  for (const X3DStatements::Unit& unit : statements.units)
    if (unit.category == kLength) head.units.push_back(unit);
  head.version = scene.language() == Language::x3d ? scene.version() : kFirstX3DVersion;
  const Levels levels = LevelCollector(scene, translator).collect();
  const auto holds = [&](const Profile& profile) {
    return std::all_of(levels.begin(), levels.end(),
                       [&](const auto& used) { return used.second <= level_in(profile, used.first); });
  };
  const auto* const found = std::find_if(std::begin(kWrittenProfiles), std::end(kWrittenProfiles), holds);
  const Profile& profile = found == std::end(kWrittenProfiles) ? *std::prev(found) : *found;
  head.profile = profile.name;
  for (const auto& [name, level] : levels)
    if (level > level_in(profile, name)) head.components.push_back({name, level});
  return head;
}

}  // namespace gs::vrml
