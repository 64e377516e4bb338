#pragma once

#include "app/formats/datasets/arrays/array_file.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace gs::app {

/// Decodes a picture with the decoders of GDCM. `to` gets native samples of 1, 2 or 4 bytes, those of a pixel together.
/// Returns an empty text, or a message.
[[nodiscard]] std::string decode_jpeg(std::span<const std::byte> bytes, const PictureForm& form,
                                      std::vector<std::byte>& to);
[[nodiscard]] std::string decode_jpeg_ls(std::span<const std::byte> bytes, const PictureForm& form,
                                         std::vector<std::byte>& to);
[[nodiscard]] std::string decode_jpeg_2000(std::span<const std::byte> bytes, const PictureForm& form,
                                           std::vector<std::byte>& to);

}  // namespace gs::app
