#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/world_loading.h"

#include <functional>

namespace gs::app {

/// Receives what the streams of a world lack for one picture, if views choose their parts. `draw` draws the picture, or
/// does as if. Each time, the streams note what they lack. Warns if the streams fail, or after `seconds`.
void receive_for_picture(WorldLoading& loading, const LoadedWorld& world, double seconds,
                         const std::function<void()>& draw);

}  // namespace gs::app
