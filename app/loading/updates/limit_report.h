#pragma once

#include "base/diagnostic.h"
#include "render/scene/render_list.h"

namespace gs::app {

/// Reports the objects that limits removed from a picture: one error per reason.
void report_limits(const render::RenderList& list, Diagnostics& diagnostics);

}  // namespace gs::app
