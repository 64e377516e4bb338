#include "vrml/inventor/reader.h"
#include "vrml/json/reader.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/scene_reader.h"
#include "vrml/xml/reader.h"

// Readers of all grammars. Their folders include vrml/syntax/, so this folder joins them.
namespace gs::vrml {

std::unique_ptr<SceneReader> make_reader(Grammar grammar, SceneGraph& scene, Diagnostics& diagnostics) {
  switch (grammar) {
    case Grammar::x3d_xml:
      return std::make_unique<xml::Reader>(scene, diagnostics);
    case Grammar::x3d_json:
      return std::make_unique<json::Reader>(scene, diagnostics);
    case Grammar::vrml97:
    case Grammar::x3d_classic:
      break;
    case Grammar::inventor:
      return std::make_unique<inventor::Reader>(scene, diagnostics);
  }
  auto parser = std::make_unique<Parser>(scene, diagnostics);
  if (grammar == Grammar::x3d_classic) parser->set_headerless_language(Language::x3d);
  return parser;
}

}  // namespace gs::vrml
