#pragma once

#include "vrml/scene/scene_graph.h"

#include <memory>
#include <string_view>

namespace gs::vrml {

/// Type of the node that stands for the USE of an imported node, between the children of a group. Its only field `name`
/// is the imported name. ISO/IEC 19775-1 has no such USE, but X_ITE reads it.
[[nodiscard]] const NodeType& imported_use_type();

/// Returns the type that names the element of such a USE in XML and JSON.
[[nodiscard]] const NodeType& imported_use_element();

/// Node of the content of an Inline. `scene` is null if there is none.
struct ExportedNode {
  std::shared_ptr<SceneGraph> scene;
  NodeId node;
};
/// Returns the node that a scene imports under a name. Follows content that exports an imported node. Returns an empty
/// result while an Inline is not loaded.
[[nodiscard]] ExportedNode find_imported(const SceneGraph& scene, std::string_view local);

}  // namespace gs::vrml
