#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Prints the scene of a file as VRML97 text.
int run_print(const LoadingOptions& options);

}  // namespace gs::app
