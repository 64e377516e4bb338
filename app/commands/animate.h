#pragma once

#include "app/commands/common/option_groups.h"

namespace gs::app {

/// Options of `animate`.
struct AnimateCommand : LoadingOptions, PictureOptions {};
int run_animate(const AnimateCommand& options);
std::optional<std::string> check_animate(const AnimateCommand& options);

}  // namespace gs::app
