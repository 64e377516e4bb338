#pragma once

#include "tests/vrml/events/trace.h"
#include "tests/watched.h"

#include <string>
#include <string_view>

namespace gs::vrml::traces {

/// Reads a text into a running world, and returns its roots.
inline MFNode read(World& world, const std::string& text) {
  Diagnostics diagnostics;
  const RunTimeNodes made = read_into(world.scene(), "made.wrl", text, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
  REQUIRE_EACH(diagnostics.errors() == 0);
  world.execution().scenes().attach(world.scene());
  return made.roots;
}

inline Route route_of(const SceneGraph& scene, NodeId from, std::string_view event_out, NodeId to,
                      std::string_view event_in) {
  return {from, to, scene.node(from).type->find_event_out(event_out), scene.node(to).type->find_event_in(event_in)};
}

inline MFNode only(NodeId node) {
  MFNode list;
  list.push_back(node);
  return list;
}

}  // namespace gs::vrml::traces
