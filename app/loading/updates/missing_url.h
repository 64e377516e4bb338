#pragma once

#include "vrml/scene/values/field_value.h"

#include <string>

namespace gs::app {

/// Returns the message for a url list in which no URL works. `why` is the problem of the first URL, or empty.
[[nodiscard]] std::string why_missing(const vrml::MFString& urls, const std::string& why);

}  // namespace gs::app
