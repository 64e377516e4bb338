#pragma once

#include "app/formats/common/asset.h"

#include <cstddef>
#include <span>

namespace gs::app {

/// Reports whether a file begins like a glTF asset with Gaussian splats (KHR_gaussian_splatting).
[[nodiscard]] bool is_gltf_splats(std::span<const std::byte> bytes);
/// Imports the Gaussian splats of a glTF asset, transformed to world space, as Gaussians. Reports other primitives,
/// which are left out. Only `source.read_file` opens external buffers. Safe for untrusted input.
[[nodiscard]] Asset read_gltf_splats(const ImportSource& source);

}  // namespace gs::app
