#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `info`.
struct InfoCommand : InputOptions, ReportOptions {};
int run_info(const InfoCommand& options);

}  // namespace gs::app
