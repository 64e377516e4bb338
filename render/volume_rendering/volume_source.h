#pragma once

#include "render/scene/volume_look.h"

#include <string>
#include <vector>

namespace gs::render {

/// GLSL of a look for the ray caster, after kVolumeRayInputs and before kVolumeRayMain.
struct VolumeSource {
  std::string defines;
  std::string code;
  bool lights = false;  // the code needs kLightingShader
};

/// Returns the steps of a look in the order of their numbers. The inner steps of a blend follow it.
[[nodiscard]] std::vector<const VolumeStep*> numbered_steps(const VolumeLook& look);

/// Returns the code of a look. Looks with equal code differ only in textures and values of uniforms:
/// values_N, normals_N, table_N_0, table_N_1, voxels_N and gradients_N of step N.
[[nodiscard]] VolumeSource volume_source(const VolumeLook& look);

/// Reports whether a step needs the gradients of its volume.
[[nodiscard]] bool needs_gradients(const VolumeStep& step);
/// Reports whether a step of the list, or isosurfaces, need the gradients of the volume.
[[nodiscard]] bool needs_gradients(const VolumeLook& look);

}  // namespace gs::render
