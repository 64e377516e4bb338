#pragma once

#include "app/formats/dicom/dicom_image.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gs::app {

/// Decodes a frame. `to` gets its samples as native numbers of DicomPixels::sample_bytes(), those of a pixel together.
/// Bits that are not stored are 0, or repeat the sign. Colours stay in their space. Returns a message on failure.
/// Safe for untrusted files.
[[nodiscard]] std::optional<std::string> decode_dicom_frame(const DicomFile& file, const DicomPixels& pixels,
                                                            std::uint32_t frame, std::vector<std::byte>& to);

/// Converts a decoded frame to red, green and blue, 8 bits each.
void dicom_colors(const DicomImage& image, std::vector<std::byte>& frame);

}  // namespace gs::app
