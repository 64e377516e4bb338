#pragma once

#include "vrml/scene/budget.h"

#include <memory>

namespace gs::app {

/// Budget that all parts of one world share; never null.
using WorldBudget = std::shared_ptr<vrml::Budget>;

/// Returns a budget for a file that is read alone.
[[nodiscard]] inline WorldBudget own_budget() { return std::make_shared<vrml::Budget>(); }

}  // namespace gs::app
