#pragma once

// X3D scenes of tests, from fragments in classic encoding.

#include "render/collection/collector.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

namespace gs::render::testing {

inline std::unique_ptr<vrml::SceneGraph> x3d_scene(const std::string& body) {
  auto scene = std::make_unique<vrml::SceneGraph>("test.x3dv");
  scene->texts().at(0).set_language(vrml::Language::x3d, 40);
  Diagnostics diagnostics;
  vrml::Parser parser(*scene, diagnostics);
  CHECK(parser.parse_fragment(body) == vrml::ParseOutcome::complete);
  for (const Diagnostic& each : diagnostics.entries()) FAIL_CHECK(each.message);
  return scene;
}

/// Returns the render list of an X3D scene, without Viewpoints.
inline RenderList x3d_list(const std::string& body) {
  const auto scene = x3d_scene(body);
  MeshCache meshes;
  RenderList list = collect(*scene, {}, meshes);
  list.viewpoints.clear();
  list.places.clear();
  return list;
}

}  // namespace gs::render::testing
