#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `export`.
struct ExportCommand : ConversionOptions {
  bool vrml97 = false;
};
int run_export(const ExportCommand& options);
std::optional<std::string> check_export(const ExportCommand& options);

}  // namespace gs::app
