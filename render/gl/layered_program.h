#pragma once

#include "render/scene/layered_material.h"

#include <cstdint>
#include <string>

namespace gs::render {

/// Returns a text that is equal for two materials if they can use one program.
[[nodiscard]] std::string layered_key(const LayeredMaterial& material);

/// Parts of the program of a layered material, for make_program().
struct LayeredSource {
  std::string defines;  // without LIT, NORMALS, FOG, CUT_OUT and those of the lights
  std::string layers;   // declarations and functions of the layers
  std::string apply;    // statements in the main function
};
/// Writes GLSL for the layers. `sets` are the coordinate sets of the mesh; 0 means that only texture_coordinates exist.
[[nodiscard]] LayeredSource layered_source(const LayeredMaterial& material, std::size_t sets);

/// Reports whether a layer needs normals, although the material may be unlit.
[[nodiscard]] bool needs_normals(const LayeredMaterial& material);
/// Reports whether a layer takes the texture coordinates of the mesh.
[[nodiscard]] bool needs_coordinates(const LayeredMaterial& material);

}  // namespace gs::render
