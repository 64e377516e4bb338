#pragma once

#include "vrml/scene/values/field_value.h"

#include <cstddef>

namespace gs::app::script {

/// Returns the bytes that a value takes, including the texts of an MFString and the pixels of an MFImage. A text or an
/// image that several elements share is counted for each of them.
[[nodiscard]] std::size_t bytes_of(const vrml::FieldValue& value);
/// Returns the bytes of an MF value's array, without texts and pixels, or of a boxed SF value. Constant time.
[[nodiscard]] std::size_t block_bytes_of(const vrml::FieldValue& value);
/// Returns the bytes of the texts or pixels of the elements from index `first` on. Returns 0 if the value is no
/// MFString and no MFImage.
[[nodiscard]] std::size_t text_bytes_of(const vrml::FieldValue& value, std::size_t first);

}  // namespace gs::app::script
