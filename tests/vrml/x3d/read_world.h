#pragma once

#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"
#include "vrml/syntax/scene_reader.h"

#include <catch2/catch.hpp>

#include <string>
#include <string_view>

namespace gs::vrml::test {

/// World that a reader has read.
struct ReadWorld {
  SceneGraph scene;
  Diagnostics diagnostics;
  ParseOutcome outcome = ParseOutcome::complete;

  /// Reads a text in pieces of `piece` bytes; 0 means whole.
  ReadWorld(Grammar grammar, std::string_view text, std::size_t piece = 0, const Limits& limits = {})
      : scene("world", limits) {
    const auto reader = make_reader(grammar, scene, diagnostics);
    if (piece == 0) piece = text.size() + 1;
    for (std::size_t i = 0; i < text.size(); i += piece) reader->push(text.substr(i, piece));
    outcome = reader->finish();
  }

  [[nodiscard]] std::string text() const { return print(scene); }
  /// Returns LINE:COLUMN: SEVERITY MESSAGE of each diagnostic.
  [[nodiscard]] std::string messages() const {
    std::string text;
    for (const Diagnostic& one : diagnostics.entries())
      text += std::to_string(one.location.line) + ':' + std::to_string(one.location.column) +
              (one.severity == Severity::error ? ": error " : ": warning ") + one.message + '\n';
    return text;
  }
};

/// Returns the printed world of a text in classic encoding without header.
[[nodiscard]] inline std::string printed_classic(const std::string& text) {
  const ReadWorld world(Grammar::x3d_classic, "#X3D V3.3 utf8\nPROFILE Immersive\n" + text);
  CHECK(world.messages() == "");
  return world.text();
}

/// Requires that a text gives the same world and messages for each size of its pieces, and that no prefix crashes.
inline void check_pieces(Grammar grammar, std::string_view text) {
  const ReadWorld whole(grammar, text);
  for (std::size_t split = 1; split < text.size(); ++split) {
    SceneGraph scene("world");
    Diagnostics diagnostics;
    const auto reader = make_reader(grammar, scene, diagnostics);
    reader->push(text.substr(0, split));
    (void)reader->open_nodes();
    reader->push(text.substr(split));
    const ParseOutcome outcome = reader->finish();
    if (outcome != whole.outcome || print(scene) != whole.text() ||
        diagnostics.entries().size() != whole.diagnostics.entries().size())
      FAIL("a split after " << split << " bytes gives another world");
    for (std::size_t i = 0; i < diagnostics.entries().size(); ++i)
      if (diagnostics.entries()[i].message != whole.diagnostics.entries()[i].message)
        FAIL("a split after " << split << " bytes gives another message");
    const ReadWorld prefix(grammar, text.substr(0, split));
    CHECK(prefix.outcome != ParseOutcome::complete);
  }
  for (const std::size_t piece : {1, 2, 3, 7}) {
    const ReadWorld pieces(grammar, text, piece);
    CHECK(pieces.text() == whole.text());
    CHECK(pieces.messages() == whole.messages());
  }
}

}  // namespace gs::vrml::test
