#pragma once

#include "app/base/read_file.h"
#include "app/formats/common/scene_builder.h"

#include <tiny_gltf.h>

#include <cstddef>
#include <optional>
#include <span>

namespace gs::app {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

/// Parses an asset with tinygltf. First checks input that tinygltf does not check: nesting depth, counts, and chunks
/// beyond the end. Images stay encoded: those of data: URLs in Image::image, the others in their files. On failure,
/// reports an error and returns nullopt.
[[nodiscard]] std::optional<tinygltf::Model> load_gltf(std::span<const std::byte> bytes, const ReadFile& read_file,
                                                       SceneBuilder& builder);

}  // namespace gs::app
