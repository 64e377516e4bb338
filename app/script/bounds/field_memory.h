#pragma once

#include "vrml/scene/field_value.h"

#include <cstddef>

namespace gs::app::script {

/// Returns the bytes that a list takes, including the texts of an MFString. Texts that elements share count each time.
[[nodiscard]] std::size_t bytes_of(const vrml::FieldValue& value);
/// Returns the bytes of the list's block alone, in constant time.
[[nodiscard]] std::size_t block_bytes_of(const vrml::FieldValue& value);
/// Returns the bytes of the texts of elements from `first` on. 0 if the list is no MFString.
[[nodiscard]] std::size_t text_bytes_of(const vrml::FieldValue& value, std::size_t first);

}  // namespace gs::app::script
