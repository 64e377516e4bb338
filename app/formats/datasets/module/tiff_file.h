#pragma once

#include "app/formats/datasets/arrays/array_file.h"

namespace gs::app {

/// Opens a TIFF or BigTIFF file. Its pages of the same form are one array: page, row, column, with the samples of a
/// pixel as parts. Pages that are small versions of others, or masks, are left out. Attributes of an array:
/// - "description": text of the first page
/// - "resolution": pixels per unit along x and y, and the unit (1 none, 2 inch, 3 cm)
/// - "colors": 1 if the samples are red, green, blue and perhaps opacity
/// - "nodata": number that GDAL writes for missing values
/// - "pages": number of each page in the file
[[nodiscard]] ArrayFileResult open_tiff_arrays(ArrayBytes bytes, std::size_t cache_bytes);

}  // namespace gs::app
