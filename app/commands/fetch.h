#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `fetch`.
struct FetchCommand : LoadingOptions, ReportOptions {};
int run_fetch(const FetchCommand& options);
std::optional<std::string> check_fetch(const FetchCommand& options);

}  // namespace gs::app
