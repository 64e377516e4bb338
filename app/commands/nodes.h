#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `nodes`.
struct NodesCommand : CommandOptions {
  bool markdown = false;
};
int run_nodes(const NodesCommand& options);

}  // namespace gs::app
