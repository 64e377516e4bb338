#pragma once

#include "render/scene/render_list.h"
#include "vrml/scene/diagnostic.h"

namespace gs::app {

/// Says what limits kept out of a picture: an error for each reason.
void report_left_out(const render::RenderList& list, vrml::Diagnostics& diagnostics);

}  // namespace gs::app
