#pragma once

#include "app/formats/common/scene_builder.h"
#include "app/formats/mesh/obj.h"

#include <cstddef>
#include <span>
#include <string>
#include <unordered_map>

namespace gs::app {

using ObjMaterials = std::unordered_map<std::string, Look>;

/// Adds the materials of one MTL file; a name that is there already keeps its first meaning. `library` is
/// the name under which the OBJ file knows it: the names of textures are relative to it.
void read_obj_materials(std::span<const std::byte> bytes, const std::string& library, ObjMaterials& materials,
                        SceneBuilder& builder);

}  // namespace gs::app
