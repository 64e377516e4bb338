#pragma once

#include "app/formats/common/asset.h"
#include "app/formats/common/transfer.h"

#include <memory>

// Scenes of importers between this process and a child: nodes of few types with their fields and names.
namespace gs::app {

/// Reports whether write_scene() can write a scene: its roots lead only to nodes of the types that importers make.
[[nodiscard]] bool can_transfer(const vrml::SceneGraph& scene);
/// Writes such a scene.
void write_scene(TransferWriter& to, const vrml::SceneGraph& scene);
/// Reads a scene. Trusts nothing: nodes have the types of importers, and fields have the types of their declarations.
/// Nodes refer only to earlier ones, so there are no cycles, and are nested no deeper than the limit. Throws
/// Impossible; or OutOfBudget, because the memory is charged to the budget.
[[nodiscard]] std::unique_ptr<vrml::SceneGraph> read_scene(TransferReader& from, const ImportSource& source);

}  // namespace gs::app
