#pragma once

#include "vrml/inventor/output/sharing.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"
#include "vrml/syntax/scene_reader.h"

#include <catch2/catch.hpp>

#include <cctype>
#include <map>
#include <string>
#include <string_view>

/// Worlds that the reader of VRML 1.0 and Inventor converts, for its tests.
namespace gs::vrml::test {

/// World that was read from a text of any grammar.
struct Converted {
  SceneGraph scene;
  Diagnostics diagnostics;
  ParseOutcome outcome = ParseOutcome::complete;

  explicit Converted(std::string_view text, std::size_t piece = std::string_view::npos, const Limits& limits = {})
      : scene("world.wrl", limits) {
    const auto reader = make_reader(grammar_of(text), scene, diagnostics);
    for (std::size_t at = 0; at < text.size(); at += std::min(piece, text.size() - at))
      reader->push(text.substr(at, piece));
    outcome = reader->finish();
  }
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const Diagnostic& one : diagnostics.entries()) text += one.text() + "\n";
    return text;
  }
  [[nodiscard]] bool says(std::string_view words) const { return messages().find(words) != std::string::npos; }
};

/// Prints a scene. Names become numbers in the order of their definition, because generated names differ.
inline std::string with_plain_names(const SceneGraph& scene) {
  const std::string text = print(scene);
  std::map<std::string, std::string> numbers;
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    const bool keyword = text.compare(at, 4, "DEF ") == 0 || text.compare(at, 4, "USE ") == 0;
    if (!keyword || (at > 0 && !std::isspace(static_cast<unsigned char>(text[at - 1])))) {
      result += text[at++];
      continue;
    }
    const std::size_t end = text.find_first_of(" \n", at + 4);
    const std::string name = text.substr(at + 4, end - at - 4);
    const std::string number = std::to_string(numbers.size());
    result += text.substr(at, 4) + "n" + numbers.try_emplace(name, number).first->second;
    at = end;
  }
  return result;
}

inline const std::string kVrml1 = "#VRML V1.0 ascii\n";
inline const std::string kInventor = "#Inventor V2.1 ascii\n";

/// Checks that a text converts to the same scene as a text of VRML97.
inline void check_converts(const std::string& text, const std::string& vrml97) {
  const Converted converted(text);
  Converted expected("#VRML V2.0 utf8\n" + vrml97);
  inventor::share_equal_nodes(expected.scene);
  INFO(text);
  INFO(converted.messages());
  CHECK(expected.messages().empty());
  CHECK(with_plain_names(converted.scene) == with_plain_names(expected.scene));
}

}  // namespace gs::vrml::test
