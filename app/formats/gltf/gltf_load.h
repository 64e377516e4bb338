#pragma once

#include "app/base/read_file.h"
#include "app/formats/common/scene_builder.h"

#include <tiny_gltf.h>

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace gs::app {

inline constexpr const char* kDracoExtension = "KHR_draco_mesh_compression";
inline constexpr const char* kSplatExtension = "KHR_gaussian_splatting";
/// Draft extensions for splats as SPZ. kSpzExtension is within kSplatExtension; later versions of it append a suffix to
/// the name. kFormerSpzExtension is an earlier draft, beside kSplatExtension or without it.
inline constexpr std::string_view kSpzExtension = "KHR_gaussian_splatting_compression_spz";
inline constexpr const char* kFormerSpzExtension = "KHR_spz_gaussian_splats_compression";

/// Parses an asset with tinygltf. First checks input that tinygltf does not check: nesting depth, counts, and chunks
/// beyond the end. Images stay encoded: those of data: URLs in Image::image, the others in their files. On failure,
/// reports an error and returns nullopt.
[[nodiscard]] std::optional<tinygltf::Model> load_gltf(std::span<const std::byte> bytes, const ReadFile& read_file,
                                                       SceneBuilder& builder);

}  // namespace gs::app
