#pragma once

#include "base/diagnostic.h"
#include "render/scene/render_list.h"

namespace gs::app {

/// Reports the objects that are missing from a picture because of limits. Adds one error per kind of limit.
void report_limits(const render::RenderList& list, Diagnostics& diagnostics);

}  // namespace gs::app
