#pragma once

#include "app/formats/common/mesh_asset.h"

#include <cstddef>
#include <span>
#include <string>
#include <unordered_map>

namespace gs::app {

using ObjMaterials = std::unordered_map<std::string, Look>;

/// Adds the materials of an MTL file; existing names keep their first definition. `library` is its name in the OBJ
/// file; texture names are relative to it.
void read_obj_materials(std::span<const std::byte> bytes, const std::string& library, ObjMaterials& materials,
                        MeshBuilder& builder);

}  // namespace gs::app
