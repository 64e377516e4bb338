#pragma once

#include "app/formats/common/mesh_asset.h"

#include <cstddef>
#include <span>
#include <string>
#include <unordered_map>

namespace gs::app {

using ObjMaterials = std::unordered_map<std::string, Look>;

/// Adds the materials of an MTL file to `materials`. A name that is already defined keeps its definition. `library` is
/// the name of the MTL file in the OBJ file. Texture names are relative to that file.
void read_obj_materials(std::span<const std::byte> bytes, const std::string& library, ObjMaterials& materials,
                        MeshBuilder& builder);

}  // namespace gs::app
