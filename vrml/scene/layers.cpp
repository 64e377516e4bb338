#include "vrml/scene/layers.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace gs::vrml {
namespace {

constexpr std::size_t kMaxLayers = 256;

/// Search for a node below layers, through PROTO instances and Inlines. Visits each node once for all layers.
class LayerSearch {
 public:
  LayerSearch(const SceneGraph& scene, NodeId node) : scene_(scene), node_(node) {}

  /// Reports whether the node is at `top` or below it.
  bool finds_below(const SceneGraph& world, NodeId top) {
    if (!world.contains(top)) return false;
    pending_.push_back({&world, top, false});
    while (!pending_.empty()) {
      Step& step = pending_.back();
      const auto [scene, id, entered] = step;
      State& state = state_of(*scene, id);
      if (entered) {
        bool found = false;
        for_each_below(*scene, id, [&](const SceneGraph& inner_scene, NodeId inner) {
          found = found || state_of(inner_scene, inner) == State::found;
        });
        state_of(*scene, id) = found ? State::found : State::absent;
        pending_.pop_back();
      } else if (state != State::unknown) {
        pending_.pop_back();  // known, or a cycle
      } else if (scene == &scene_ && id == node_) {
        state = State::found;
        pending_.pop_back();
      } else {
        state = State::open;
        step.entered = true;
        for_each_below(*scene, id, [&](const SceneGraph& inner_scene, NodeId inner) {
          pending_.push_back({&inner_scene, inner, false});
        });
      }
    }
    return state_of(world, top) == State::found;
  }

 private:
  enum class State : std::uint8_t { unknown, open, absent, found };
  struct Step {
    const SceneGraph* scene;
    NodeId node;
    bool entered;
  };

  State& state_of(const SceneGraph& scene, NodeId id) {
    std::vector<State>& states = states_[&scene];
    if (states.empty()) states.resize(scene.nodes().count() + 1);
    return states[id.index];
  }

  template <class Function>
  static void for_each_below(const SceneGraph& scene, NodeId id, Function&& function) {
    const Node& node = scene.node(id);
    const auto add = [&](const SceneGraph& of, NodeId inner) {
      if (of.contains(inner)) function(of, inner);
    };
    for (const NodeId inner : node.expansion) add(scene, inner);
    for (std::size_t i = 0; i < node.type->defaults.size(); ++i) {
      if (const auto* one = std::get_if<SFNode>(&node.values[i])) add(scene, *one);
      if (const auto* many = std::get_if<MFNode>(&node.values[i]))
        for (const NodeId inner : *many) add(scene, inner);
    }
    if (const GeoTiles* const tiles = scene.inlines().tiles_of(id))
      for (const MFNode& part : {tiles->root, tiles->children})
        for (const NodeId tile : part) add(scene, tile);
    if (const SceneGraph* const inlined = scene.inlines().of(id))
      for (const NodeId root : inlined->roots()) add(*inlined, root);
  }

  const SceneGraph& scene_;
  NodeId node_;
  std::vector<Step> pending_;
  std::unordered_map<const SceneGraph*, std::vector<State>> states_;
};

template <class T>
const T* layer_field(const Node& node, std::string_view field) {
  const InterfaceDeclaration* const found = node.type->find_field(field);
  return found && found->slot >= 0 ? std::get_if<T>(&node.values[found->slot]) : nullptr;
}

bool layer_flag(const SceneGraph& world, NodeId layer, std::string_view field) {
  const auto* given = world.contains(layer) ? layer_field<SFBool>(world.node(layer), field) : nullptr;
  return !given || *given;
}

}  // namespace

std::optional<LayerSet> layer_set_of(const SceneGraph& world) {
  for (const NodeId root : world.roots()) {
    const NodeId id = world.resolve(root);
    if (!id || world.node(id).type->read_as != NodeKind::layer_set) continue;
    const Node& node = world.node(id);
    LayerSet set;
    set.node = id;
    if (const auto* layers = layer_field<MFNode>(node, "layers"))
      for (std::size_t i = 0; i < std::min(layers->size(), kMaxLayers); ++i)
        set.layers.push_back(world.resolve(layers->begin()[i]));
    const auto exists = [&](int layer) { return layer >= 0 && layer <= static_cast<int>(set.layers.size()); };
    if (const auto* active = layer_field<SFInt32>(node, "activeLayer"); active && exists(*active)) set.active = *active;
    if (const auto* order = layer_field<MFInt32>(node, "order"))
      for (const SFInt32 layer : *order)
        if (exists(layer) && std::find(set.order.begin(), set.order.end(), layer) == set.order.end())
          set.order.push_back(layer);
    return set;
  }
  return std::nullopt;
}

std::vector<int> layers_of(const SceneGraph& world, const LayerSet& set, const SceneGraph& scene, NodeId node) {
  LayerSearch search(scene, node);
  std::vector<int> found;
  for (const NodeId root : world.roots())
    if (found.empty() && world.resolve(root) != set.node && search.finds_below(world, root)) found.push_back(0);
  for (std::size_t i = 0; i < set.layers.size(); ++i)
    if (search.finds_below(world, set.layers[i])) found.push_back(static_cast<int>(i) + 1);
  if (found.empty()) found.push_back(0);
  return found;
}

ClipBoundary clip_boundary_of(const SceneGraph& world, NodeId layer) {
  const auto* viewport = world.contains(layer) ? layer_field<SFNode>(world.node(layer), "viewport") : nullptr;
  return clip_boundary_of_viewport(world, viewport ? world.resolve(*viewport) : NodeId{});
}

ClipBoundary clip_boundary_of_viewport(const SceneGraph& world, NodeId viewport) {
  constexpr ClipBoundary kWhole{0, 1, 0, 1};
  if (!world.contains(viewport)) return kWhole;
  const auto* given = layer_field<MFFloat>(world.node(viewport), "clipBoundary");
  if (!given || given->size() < kWhole.size()) return kWhole;
  ClipBoundary boundary{};
  for (std::size_t i = 0; i < boundary.size(); ++i) {
    const double at = given->begin()[i];
    if (!(at >= 0 && at <= 1)) return kWhole;
    boundary[i] = at;
  }
  return boundary[0] < boundary[1] && boundary[2] < boundary[3] ? boundary : kWhole;
}

bool is_pickable(const SceneGraph& world, NodeId layer) { return layer_flag(world, layer, "pickable"); }

bool is_visible(const SceneGraph& world, NodeId layer) { return layer_flag(world, layer, "visible"); }

bool is_layout_layer(const SceneGraph& world, NodeId layer) {
  return world.contains(layer) && world.node(layer).type->find_field("layout") != nullptr;
}

}  // namespace gs::vrml
