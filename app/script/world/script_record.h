#pragma once

#include "app/script/boundary/program_host.h"
#include "app/script/read_rule.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace gs::app::script {

/// Script of a running world, and what the world knows about its program.
struct ScriptRecord {
  vrml::EventNode node = 0;
  vrml::SceneGraph* scene = nullptr;
  vrml::NodeId id;
  vrml::Language language = vrml::Language::vrml97;  // of the text of the Script: selects the API
  std::shared_ptr<const vrml::TextSource> source;    // source of the text that contains the url field
  /// Cached decisions of ReadGuard, by the source of the node. The shared pointers keep the keys valid.
  std::unordered_map<const vrml::TextSource*, std::pair<std::shared_ptr<const vrml::TextSource>, Reading>> readings;
  /// Values of fields and eventOuts that the program knows, by index in the node type's interfaces.
  std::vector<vrml::FieldValue> known;
  bool runs = false, waits = false, off = false, has_processed = false, has_prepare = false, told_direct = false;
  bool ended = false;         // shutdown() was called
  bool acts_at_once = false;  // the program changes ROUTEs or adds nodes, which acts before it returns
  int faults = 0;
  std::size_t next_url = 0;  // index of the first entry of the url field that was not tried yet
};

/// Returns the text that contains the url field of a Script.
[[nodiscard]] const vrml::SourceText& text_of_program(const ScriptRecord& script);
/// Returns the name of a Script in messages.
[[nodiscard]] std::string label_of(const ScriptRecord& script);

}  // namespace gs::app::script
