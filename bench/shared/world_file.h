#pragma once

#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"

#include <fstream>
#include <sstream>

namespace gs::bench {

/// Reads a VRML97 file into an empty scene, as far as it goes.
inline void read_world(const char* path, vrml::SceneGraph& scene) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  Diagnostics diagnostics;
  (void)vrml::parse(text.str(), scene, diagnostics);
}

}  // namespace gs::bench
