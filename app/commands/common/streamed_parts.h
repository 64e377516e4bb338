#pragma once

#include "app/loading/updates/loaded_world.h"
#include "app/loading/updates/resource_updates.h"
#include "app/loading/world_loading.h"

#include <functional>

namespace gs::app {

/// Receives the data that one picture needs from streams with parts chosen by views. `draw` draws the picture, or only
/// simulates drawing it. Each call lets the streams note their missing parts. `arrive` adds new vectors to the
/// world; if null, the caller does so. Warns on failures, or after `seconds`.
void receive_for_picture(WorldLoading& loading, const LoadedWorld& world, double seconds,
                         const std::function<void()>& draw,
                         const std::function<void(ResourceUpdates updates)>& arrive = {});

}  // namespace gs::app
