#pragma once

#include "app/interface/model/ui_data.h"
#include "app/session/session.h"

namespace gs::app {

/// Returns the data of the active viewport for the interface.
[[nodiscard]] UiData describe_data(Session& session);
/// Carries out the user's requests for data.
void apply_data(const UiDataActions& actions, Session& session);

}  // namespace gs::app
