#include "vrml/events/node_names.h"

#include <algorithm>

namespace gs::vrml {

NodeNames::NodeNames(const SceneGraph& root) {
  scenes_.push_back({&root});
  for (std::size_t i = 0; i < scenes_.size(); ++i) {
    count(scenes_[i]);
    std::vector<std::uint32_t> places;
    for (const auto& [place, content] : scenes_[i].scene->inlines())
      if (content) places.push_back(place);
    std::sort(places.begin(), places.end());
    const SceneGraph& scene = *scenes_[i].scene;
    for (const std::uint32_t place : places) scenes_.push_back({scene.inlined(scene.id_at(place))});
  }
}

void NodeNames::count(Numbers& numbers) {
  for (auto i = static_cast<std::uint32_t>(numbers.of_node.size()); i <= numbers.scene->node_count(); ++i) {
    const Node& node = numbers.scene->node(numbers.scene->id_at(i));
    numbers.of_node.push_back(node.in_prototype_body ? 0 : ++counts_[node.type->name]);
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
  return node.type->name + '#' + std::to_string(numbers.of_node[id.index]);
}

NodeId NodeNames::find(std::string_view name) {
  Numbers& numbers = scenes_.front();
  count(numbers);
  const SceneGraph& scene = *numbers.scene;
  const std::size_t mark = name.rfind('#');
  std::vector<bool> inside(scene.node_count() + 1);
  NodeId found, found_inside;
  for (std::uint32_t i = 1; i <= scene.node_count(); ++i) {
    const NodeId id = scene.id_at(i);
    const Node& node = scene.node(id);
    if (node.in_prototype_body) continue;
    if (!node.expansion.empty() && node.type->prototype)
      for (std::size_t k = 0; k < node.type->prototype->nodes.size(); ++k) inside[node.expansion_first + k] = true;
    if (node.name == name) (inside[i] ? found_inside : found) = id;
    if (node.name.empty() && mark != std::string_view::npos && node.type->name == name.substr(0, mark) &&
        std::to_string(numbers.of_node[i]) == name.substr(mark + 1))
      return id;
  }
  return found ? found : found_inside;
}

}  // namespace gs::vrml
