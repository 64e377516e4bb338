#pragma once

#include "app/formats/datasets/module/hdf5_driver.h"

#include <span>

namespace gs::app {

/// Makes the values of boxes of a dataset readable with few requests, for a file on a server. First looks up all
/// chunks of the boxes. Returns false if they cannot be received.
[[nodiscard]] bool hdf5_need_boxes(Hdf5Source& source, hid_t dataset, hid_t type, const ArrayInfo& array,
                                   std::span<const ArrayBox> boxes);

}  // namespace gs::app
