#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `trace`.
struct TraceCommand : LoadingOptions, SizeOptions, SimulationOptions {
  std::optional<double> until;  // end of simulated time
};
int run_trace(const TraceCommand& options);
std::optional<std::string> check_trace(const TraceCommand& options);

}  // namespace gs::app
