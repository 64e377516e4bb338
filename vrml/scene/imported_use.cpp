#include "vrml/scene/imported_use.h"

#include <algorithm>
#include <string>

namespace gs::vrml {

ExportedNode find_imported(const SceneGraph& scene, std::string_view local) {
  constexpr int kMaxChain = 32;
  const SceneGraph* at = &scene;
  std::shared_ptr<SceneGraph> content;
  std::string name(local);
  for (int step = 0; step < kMaxChain; ++step) {
    const auto& imports = at->x3d().imports;
    const auto import =
        std::find_if(imports.begin(), imports.end(), [&](const auto& each) { return each.local == name; });
    if (import == imports.end()) return {};
    const NodeId inline_node = at->resolve(import->inline_node);
    const auto inlined = at->inlines().all().find(inline_node.index);
    if (!inline_node || inlined == at->inlines().all().end() || !inlined->second) return {};
    content = inlined->second;
    const auto& exports = content->x3d().exports;
    const auto found = std::find_if(exports.begin(), exports.end(),
                                    [&](const auto& each) { return each.exported == import->exported; });
    if (found == exports.end()) return {};
    if (found->node) return content->contains(found->node) ? ExportedNode{content, found->node} : ExportedNode{};
    at = content.get();
    name = found->local;
  }
  return {};
}

}  // namespace gs::vrml
