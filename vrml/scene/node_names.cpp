#include "vrml/scene/node_names.h"

#include <algorithm>
#include <utility>

namespace gs::vrml {

NodeNames::NodeNames(const SceneGraph& root) {
  scenes_.push_back({&root});
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    count(scenes_[i]);
    std::vector<std::uint32_t> places;
    for (const auto& [place, content] : scenes_[i].scene->inlines().all())
      if (content) places.push_back(place);
    std::sort(places.begin(), places.end());
    const SceneGraph& scene = *scenes_[i].scene;
    for (const std::uint32_t place : places) scenes_.push_back({scene.inlines().of(scene.nodes().id_at(place))});
  }
}

void NodeNames::count(Numbers& numbers) {
  if (std::exchange(numbers.revision, numbers.scene->nodes().revision()) == numbers.scene->nodes().revision()) return;
  numbers.of_node.resize(numbers.scene->nodes().count() + 1);
  for (std::uint32_t i = 1; i <= numbers.scene->nodes().count(); ++i) {
    const Node& node = numbers.scene->nodes().at(i);
    Number& known = numbers.of_node[i];
    if (known.generation == node.generation) continue;
    known = {node.generation, node.in_prototype_body ? 0 : ++counts_[node.type->name]};
  }
}

NodeNames::Numbers& NodeNames::numbers_of(const SceneGraph& scene) {
  const auto found = std::find_if(scenes_.begin(), scenes_.end(), [&](const Numbers& n) { return n.scene == &scene; });
  return found == scenes_.end() ? scenes_.emplace_back(Numbers{&scene}) : *found;
}

std::string NodeNames::of(const SceneGraph& scene, NodeId id) {
  if (!scene.contains(id)) return "NULL";
  const Node& node = scene.node(id);
  if (!node.name.empty()) return std::string(node.name);
  Numbers& numbers = numbers_of(scene);
  count(numbers);
  return node.type->name + '#' + std::to_string(numbers.of_node[id.index].number);
}

void NodeNames::find_names() {
  const SceneGraph& scene = *scenes_.front().scene;
  if (std::exchange(named_at_, scene.nodes().revision()) == scene.nodes().revision()) return;
  std::unordered_map<std::string_view, NodeId> inner;
  named_.clear();
  for (std::uint32_t i = 1; i <= scene.nodes().count(); ++i) {
    const NodeId id = scene.nodes().id_at(i);
    const Node& node = scene.nodes().at(i);
    if (node.in_prototype_body) continue;
    if (!node.name.empty()) (node.instance != 0 ? inner : named_)[node.name] = id;
  }
  named_.merge(inner);
}

NodeId NodeNames::find(std::string_view name) {
  find_names();
  const auto found = named_.find(name);
  if (found != named_.end()) return found->second;
  Numbers& numbers = scenes_.front();
  count(numbers);
  const std::size_t mark = name.rfind('#');
  for (std::uint32_t i = 1; mark != std::string_view::npos && i <= numbers.scene->nodes().count(); ++i) {
    const NodeId id = numbers.scene->nodes().id_at(i);
    const Node& node = numbers.scene->nodes().at(i);
    if (numbers.of_node[i].number != 0 && node.type->name == name.substr(0, mark) &&
        std::to_string(numbers.of_node[i].number) == name.substr(mark + 1))
      return id;
  }
  return {};
}

}  // namespace gs::vrml
