#pragma once

#include "app/formats/datasets/module/hdf5_driver.h"

namespace gs::app {

/// Sets type, parts and names of an array from a type of HDF5. Types that hold no numbers give NumberType::none.
void describe_hdf5_type(hid_t type, ArrayInfo& array);
/// Returns the type in memory of the elements that describe_hdf5_type() describes.
[[nodiscard]] Hdf5Handle hdf5_memory_type(hid_t type, const ArrayInfo& array);
/// Returns the attributes of an object. Leaves out those that are neither numbers nor texts, and long ones.
[[nodiscard]] std::vector<ArrayAttribute> hdf5_attributes(hid_t object);

}  // namespace gs::app
