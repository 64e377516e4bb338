#pragma once

#include "app/base/read_file.h"
#include "app/formats/common/scene_builder.h"

#include <tiny_gltf.h>

#include <cstddef>
#include <optional>
#include <span>

namespace gs::app {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";

/// Reads the asset with tinygltf, after looking for what tinygltf would not survive: depth, sheer number,
/// chunks beyond the end. Images stay encoded: those of data: URLs in Image::image, others where they are.
/// Nothing, and an error reported, where it cannot be read.
[[nodiscard]] std::optional<tinygltf::Model> load_gltf(std::span<const std::byte> bytes, const ReadFile& read_file,
                                                       SceneBuilder& builder);

}  // namespace gs::app
