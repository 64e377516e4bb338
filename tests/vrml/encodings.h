// Worlds of tests in the encodings of X3D.
#pragma once

#include "vrml/printing/print_scene.h"
#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <array>
#include <string>

namespace gs::vrml::testing {

inline constexpr std::array kX3DGrammars{Grammar::x3d_xml, Grammar::x3d_classic, Grammar::x3d_json};

inline std::string name_of(Grammar grammar) {
  switch (grammar) {
    case Grammar::x3d_xml:
      return "XML";
    case Grammar::x3d_classic:
      return "classic";
    case Grammar::x3d_json:
      return "JSON";
    default:
      return "VRML97";
  }
}

/// Returns a text in another encoding.
inline std::string encoded(const std::string& text, Grammar grammar) {
  SceneGraph scene("text.wrl");
  Diagnostics diagnostics;
  (void)parse(text, scene, diagnostics);
  return printed_scene(scene, {grammar});
}

}  // namespace gs::vrml::testing
