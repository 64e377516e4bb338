#pragma once

#include "app/formats/dicom/dicom_image.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gs::app {

/// Reads the colour tables of red, green and blue, also those in segments (PS3.3, C.7.6.3.1.5 and C.7.9.2). Returns a
/// message if one is missing or damaged.
[[nodiscard]] std::variant<std::vector<DicomTable>, std::string> read_dicom_palette(const DicomDataSet& data,
                                                                                    std::uint32_t bits_stored);

}  // namespace gs::app
