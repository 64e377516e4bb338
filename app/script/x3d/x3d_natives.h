#pragma once

#include "app/script/natives.h"

// Functions on which the library of X3D (x3d_library.cpp) is built. Programs do not see them.
namespace gs::app::script {

/// Adds the functions to a library. Their names begin with `$x3d_`.
bool define_x3d_natives(JSContext* context, JS::HandleObject library);

/// Returns the source of the library in ECMAScript.
[[nodiscard]] std::string_view x3d_library_text();

}  // namespace gs::app::script
