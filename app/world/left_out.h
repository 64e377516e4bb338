#pragma once

#include "render/scene/render_list.h"
#include "vrml/scene/diagnostic.h"

namespace gs::app {

/// Reports the objects that limits removed from a picture: one error per reason.
void report_left_out(const render::RenderList& list, vrml::Diagnostics& diagnostics);

}  // namespace gs::app
