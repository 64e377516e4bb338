#pragma once

#include "app/loading/world_loader.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <initializer_list>
#include <memory>
#include <string>

namespace gs::app {

/// Returns all diagnostics of a world, one per line.
inline std::string said(const LoadedWorld& world) {
  std::string text;
  for (const auto& diagnostic : world.diagnostics.entries()) text += diagnostic.text() + "\n";
  return text;
}

/// Returns a world of nodes of these types.
inline LoadedWorld world_with(std::initializer_list<const char*> types) {
  LoadedWorld world;
  world.scene = std::make_unique<vrml::SceneGraph>("test.wrl");
  for (const char* type : types) {
    REQUIRE(vrml::built_in_node_type(type));
    world.scene->add_root(world.scene->create(*vrml::built_in_node_type(type)));
  }
  return world;
}

/// Returns a world of this text, without its header.
inline LoadedWorld world_of(const std::string& body) {
  LoadedWorld world;
  world.scene = std::make_unique<vrml::SceneGraph>("test.wrl");
  Diagnostics diagnostics;
  (void)vrml::parse("#VRML V2.0 utf8\n" + body, *world.scene, diagnostics);
  REQUIRE(diagnostics.errors() == 0);
  return world;
}

}  // namespace gs::app
