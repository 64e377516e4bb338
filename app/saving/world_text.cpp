#include "app/saving/world_text.h"

#include "app/formats/content_types.h"
#include "app/saving/moved_urls.h"
#include "app/saving/scene_formats.h"
#include "app/saving/scene_text.h"
#include "base/gzip.h"
#include "net/base/url.h"
#include "net/files/file.h"
#include "vrml/scene/prototype.h"
#include "vrml/syntax/edits/text_edits.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <filesystem>
#include <map>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace gs::app {
namespace {

using vrml::SceneGraph;

// Returns the path of a local file, or an empty text for other URLs.
std::string local_path(const std::string& place) {
  const std::string path = net::has_scheme(place, "file") ? net::path_of_url(net::parse_url(place)) : place;
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) ? path : std::string();
}

/// Scene that was read from a text again.
struct ReadAgain {
  explicit ReadAgain(std::string_view text, const Limits& limits) : scene("text", limits) {
    outcome = vrml::parse(text, scene, diagnostics);
  }
  SceneGraph scene;
  Diagnostics diagnostics;
  vrml::ParseOutcome outcome;
};

// Finds the node and field in the file that an edit of a PROTO instance's part changes through IS (VRML97 4.8.2).
// Returns false if the part has a value of its own.
bool find_in_file(const SceneGraph& scene, vrml::NodeId& node, const vrml::InterfaceDeclaration*& field) {
  while (const std::uint32_t outer = scene.node(node).instance) {
    const vrml::NodeId instance = scene.nodes().id_at(outer);
    if (!scene.contains(instance) || !scene.node(instance).type->prototype) return false;
    const vrml::Node& holder = scene.node(instance);
    const vrml::Prototype& prototype = *holder.type->prototype;
    const std::size_t place = node.index - holder.expansion_first;
    if (place >= prototype.nodes.size()) return false;
    const vrml::InterfaceDeclaration* found = nullptr;
    for (const vrml::IsMapping& mapping : prototype.mappings)
      if (mapping.node == prototype.nodes[place] && mapping.inner == field)
        found = holder.type->find_field(mapping.outer->name);
    if (!found) return false;
    node = instance;
    field = found;
  }
  return true;
}

// Returns a value as text, or nullopt if it contains nodes without a DEF name.
std::optional<std::string> text_of_value(const vrml::FieldValue& value, const SceneGraph& scene) {
  const auto reference = [&](vrml::NodeId node) -> std::optional<std::string> {
    if (!scene.contains(node)) return "NULL";
    const std::string_view name = scene.node(node).name;
    return name.empty() ? std::nullopt : std::optional("USE " + std::string(name));
  };
  std::string text;
  if (const auto* node = std::get_if<vrml::SFNode>(&value)) return reference(*node);
  const auto* nodes = std::get_if<vrml::MFNode>(&value);
  if (!nodes) {
    vrml::print_value(text, value, scene);
    return text;
  }
  for (const vrml::NodeId node : *nodes) {
    const auto one = reference(node);
    if (!one) return std::nullopt;
    text += " " + *one;
  }
  return "[" + text + " ]";
}

/// Edits of a world as changes of its text.
struct PlannedEdits {
  std::vector<vrml::TextEdit> edits;
  std::size_t left_out = 0;
  bool possible = true;
};

PlannedEdits planned_edits(const SceneGraph& scene, const WorldEdits& edits) {
  PlannedEdits planned;
  for (const WorldEdit& edit : edits.latest()) {
    vrml::NodeId node = edit.node;
    const vrml::InterfaceDeclaration* field = edit.field;
    if (edit.scene != &scene || !scene.contains(node) || !find_in_file(scene, node, field) ||
        scene.node(node).text != &scene || scene.node(node).owner != 0) {
      ++planned.left_out;
      continue;
    }
    const vrml::Node& in_file = scene.node(node);
    const auto value = text_of_value(edit.after, scene);
    planned.possible = planned.possible && value.has_value();
    if (value) planned.edits.push_back({in_file.location, in_file.type->name, field->name, *value});
  }
  return planned;
}

// Returns the source text with the edits, or nullopt if the edits do not fit the text.
std::optional<std::string> edited_source(const std::string& source, const SceneGraph& scene,
                                         const PlannedEdits& planned) {
  if (!planned.possible) return std::nullopt;
  auto text = vrml::edited_text(source, planned.edits);
  if (!text || planned.edits.empty()) return text;
  // Reading both texts again finds a node that is used elsewhere but was replaced, and any other damage.
  const ReadAgain before(source, scene.limits()), after(*text, scene.limits());
  const bool whole = after.outcome == before.outcome && after.diagnostics.errors() <= before.diagnostics.errors() &&
                     after.scene.statements().size() == before.scene.statements().size();
  return whole ? text : std::nullopt;
}

// Adapts the URLs in the text of a file to the folder of another file.
void move_urls(std::string& text, const SceneGraph& scene, const std::string& source, const std::string& target) {
  const ReadAgain again(text, scene.limits());
  std::vector<vrml::TextEdit> moves = moved_urls(again.scene, source, target);
  if (moves.empty()) return;
  auto moved = vrml::edited_text(text, moves);
  if (!moved) {
    std::erase_if(moves, [&](const vrml::TextEdit& move) { return !vrml::edited_text(text, {&move, 1}); });
    moved = vrml::edited_text(text, moves);
  }
  if (moved) text = std::move(*moved);
}

}  // namespace

std::shared_ptr<const std::string> source_text(const std::string& place, std::size_t size) {
  const std::string path = local_path(place);
  if (path.empty()) return nullptr;
  const auto opened = net::map_file(path);
  const auto* file = std::get_if<net::MappedFile>(&opened);
  if (!file || (size != 0 && file->bytes().size() != size)) return nullptr;
  const std::span<const std::byte> bytes = file->bytes();
  if (&content_type_of(path, first_bytes(bytes)) != &content_type_of("a.wrl", {})) return nullptr;
  auto text = std::make_shared<std::string>();
  if (!is_gzip(bytes)) {
    text->assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return text;
  }
  const auto problem = gunzip(bytes, WorldBudget(std::make_shared<Budget>()), [&](std::string_view piece) {
    text->append(piece);
    return true;
  });
  return problem ? nullptr : text;
}

void keep_source_text(Document& document) {
  if (std::exchange(document.edits.has_source, true)) return;
  document.edits.source = source_text(document.world.path, document.world.bytes);
}

std::variant<WorldText, std::string> world_text(Document& document, const std::string& target) {
  if (!document.world.scene || document.is_preview) return "the file is still loading; try again when it is complete";
  keep_source_text(document);
  const SceneGraph& scene = *document.world.scene;
  const PlannedEdits planned = planned_edits(scene, document.edits);
  WorldText made;
  made.left_out = planned.left_out;
  const SceneFormat* const format = scene_format_of(target);
  const vrml::Grammar grammar = format ? format->grammar : vrml::Grammar::vrml97;
  if (document.edits.source && grammar == vrml::Grammar::vrml97)
    if (auto text = edited_source(*document.edits.source, scene, planned)) {
      made.text = std::move(*text);
      made.is_source = true;
      move_urls(made.text, scene, document.world.path, target);
      return made;
    }
  SceneText printed = scene_text(document.world, grammar, target);
  made.text = std::move(printed.text);
  made.losses = std::move(printed.losses);
  return made;
}

}  // namespace gs::app
