#pragma once

#include "vrml/scene/budget.h"

#include <memory>

namespace gs::app {

/// What everything that belongs to one world draws from; never null.
using WorldBudget = std::shared_ptr<vrml::Budget>;

/// For what is read alone.
[[nodiscard]] inline WorldBudget own_budget() { return std::make_shared<vrml::Budget>(); }

}  // namespace gs::app
