#pragma once

#include "vrml/scene/scene_graph.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace gs::vrml {

/// LayerSet of a world (ISO/IEC 19775-1 35.4.2). Layers have numbers from 1; layer 0 has all content outside of the
/// LayerSet.
struct LayerSet {
  NodeId node;
  std::vector<NodeId> layers;  // resolved; the null id for a layer that is missing
  int active = 0;              // number of the layer in which the user navigates; 0 if the field names no layer
  std::vector<int> order;      // numbers of the drawn layers, from back to front; each at most once
};

/// Returns the LayerSet among the root nodes of a world: the first one, as the standard says. Returns nullopt if there
/// is none. Takes time in proportion to the number of root nodes.
[[nodiscard]] std::optional<LayerSet> layer_set_of(const SceneGraph& world);

/// Returns the numbers of the layers that contain a node, in increasing order; only 0 for a node outside of the world.
/// `scene` is the world or the scene of one of its Inlines. Visits each node of the world at most once.
[[nodiscard]] std::vector<int> layers_of(const SceneGraph& world, const LayerSet& set, const SceneGraph& scene,
                                         NodeId node);

/// Part of a window that a Viewport covers (35.4.4): left, right, bottom and top from 0 to 1.
using ClipBoundary = std::array<double, 4>;
/// Returns the clipBoundary of the viewport of a layer or LayoutGroup; the whole window for other values.
[[nodiscard]] ClipBoundary clip_boundary_of(const SceneGraph& world, NodeId layer);
/// Returns the clipBoundary of a Viewport.
[[nodiscard]] ClipBoundary clip_boundary_of_viewport(const SceneGraph& world, NodeId viewport);
/// Returns the field `pickable` of a layer (35.3.1); true if the layer is missing.
[[nodiscard]] bool is_pickable(const SceneGraph& world, NodeId layer);
/// Returns the field `visible` of a layer (35.3.1); true if the layer is missing.
[[nodiscard]] bool is_visible(const SceneGraph& world, NodeId layer);
/// Reports whether a layer is a LayoutLayer (36.4.3).
[[nodiscard]] bool is_layout_layer(const SceneGraph& world, NodeId layer);

}  // namespace gs::vrml
