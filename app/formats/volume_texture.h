#pragma once

#include "app/formats/texture_image.h"
#include "app/formats/volume/volume.h"

#include <cstddef>
#include <span>
#include <string>
#include <variant>

namespace gs::app {

/// Reports whether a texture file is a volume that render::decode_image does not read: NIfTI, MetaImage and other
/// formats of open_volume(), or NRRD with a separate data file. `bytes` are its first bytes or all of them.
[[nodiscard]] bool is_volume_texture(std::span<const std::byte> bytes);

/// Reads such a file as slices of 8 bits. Bytes stay as they are; other values reach from the smallest to the largest
/// one, and missing values are 0. Scales a large volume down, as decode_texture() does. `origin` provides a file that
/// the header names. Safe for untrusted files.
[[nodiscard]] std::variant<Texture, render::ImageError> read_volume_texture(const std::string& path,
                                                                            const VolumeOrigin& origin,
                                                                            const WorldBudget& budget);

}  // namespace gs::app
