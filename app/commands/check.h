#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `check`.
struct CheckCommand : LoadingOptions, ReportOptions {
  bool scripts = false;  // true also compiles the programs of Scripts
};
int run_check(const CheckCommand& options);

}  // namespace gs::app
