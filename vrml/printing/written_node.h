#pragma once

#include "base/noncopyable.h"
#include "vrml/printing/made_node.h"
#include "vrml/printing/print_losses.h"
#include "vrml/scene/node.h"
#include "vrml/scene/scene_graph.h"

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <vector>

namespace gs::vrml {

/// Field, or declaration of a Script, as it is written.
struct WrittenField {
  const InterfaceDeclaration* declaration = nullptr;  // declaration in the language of the text
  std::string_view name = {};                         // name in this language
  const FieldValue* value = nullptr;                  // null if it has none
  const MadeNode* made = nullptr;                     // node in place of the value
  std::string_view is = {};                           // interface of the PROTO after IS; empty without IS
  bool declares = false;                              // the Script declares the interface

  [[nodiscard]] bool has_nodes() const { return made || (value && holds_nodes(declaration->type)); }
  /// Reports whether the value is written without nodes.
  [[nodiscard]] bool is_plain() const { return is.empty() && value && !holds_nodes(declaration->type); }
};

/// Node as it is written in the language of the text.
struct WrittenNode {
  const NodeType* type = nullptr;  // type in this language
  std::string_view name;           // DEF name; empty without DEF
  std::vector<WrittenField> fields;
  std::deque<FieldValue> changed;        // values that differ from those of the node
  std::shared_ptr<const MadeNode> made;  // owner of the values in `fields`; null for nodes of the scene
};

/// Reports whether the URL of a Script contains the program itself (ISO/IEC 19777-1 4.1; VRML97 C.2.1).
[[nodiscard]] bool is_program_url(std::string_view url);

/// Returns a program without the blanks at its end, which readers of text in XML and JSON remove.
[[nodiscard]] inline std::string_view trimmed_program(std::string_view url) {
  return url.substr(0, url.find_last_not_of(" \t\r\n") + 1);
}

using IsMappings = std::vector<const IsMapping*>;

/// Translator of nodes into the language of a text. Types and fields that the language lacks are losses. One thread.
class NodeTranslator : NonCopyable {
 public:
  /// Function that returns the changed list of a url field, or nullopt.
  using MovedUrls = std::function<std::optional<MFString>(const MFString&)>;

  NodeTranslator(Language language, MovedUrls moved_urls, PrintLosses& losses)
      : language_(language), moved_urls_(std::move(moved_urls)), losses_(losses) {}

  [[nodiscard]] Language language() const { return language_; }
  /// Returns the type that is written for nodes of `type`; null if the language has none.
  [[nodiscard]] const NodeType* written_type(const NodeType& type) { return plan(type).type; }
  /// Marks that the text declares a PROTO for browsers without this built-in type.
  void add_fallback(const NodeType& native) { fallbacks_.insert(&native); }
  /// Reports whether a PROTO or EXTERNPROTO of the text declares the type.
  [[nodiscard]] bool is_declared(const NodeType& type) const {
    return type.kind > NodeType::Kind::script ? !type.stands_in : fallbacks_.contains(&type);
  }
  /// Returns the name of the element or member of a node in XML and JSON.
  [[nodiscard]] std::string_view element_of(const NodeType& type) const {
    return is_declared(type) ? std::string_view("ProtoInstance") : type.name;
  }
  /// Returns the name of an interface of `type`; empty if the language lacks it.
  [[nodiscard]] std::string_view written_name(const NodeType& type, const InterfaceDeclaration& declaration);
  /// Reports whether the text contains the node.
  [[nodiscard]] bool is_written(const SceneGraph& scene, NodeId id) {
    return scene.contains(id) && written_type(*scene.node(id).type);
  }
  /// Returns the node with the fields that differ from their defaults in this language, and those with IS. Its name is
  /// empty.
  [[nodiscard]] WrittenNode written(const SceneGraph& scene, NodeId id, const IsMappings* mappings);
  /// Returns a node that a Vrml97Equivalent made, with the fields that differ from their defaults.
  [[nodiscard]] static WrittenNode written(const MadeNode& made);
  /// Returns a changed url list, or null if it remains.
  [[nodiscard]] std::optional<MFString> moved_urls(const MFString& urls) const {
    return moved_urls_ ? moved_urls_(urls) : std::nullopt;
  }
  /// Returns the changed default value of a PROTO's url field, or nullopt.
  [[nodiscard]] std::optional<MFString> moved_default(const NodeType& type,
                                                      const InterfaceDeclaration& declaration) const;
  /// Counts a node of a type that the language lacks.
  void add_left_out(const NodeType& type);
  void add_loss(std::string what) { losses_.add(std::move(what)); }

 private:
  /// Interface of a node type, and the one that is written for it.
  struct Pair {
    const InterfaceDeclaration* from;
    const InterfaceDeclaration* to;
    bool is_url = false, declares = false;
    bool is_standard = false;  // the Script declares the interface, but all Scripts of the language have it
  };
  /// Translation of one node type.
  struct Plan {
    const NodeType* type = nullptr;  // null if nodes are left out
    std::vector<Pair> pairs;         // in the order of the written type
    std::vector<const InterfaceDeclaration*> lost;
    const Vrml97Equivalent* equivalent = nullptr;
  };

  const Plan& plan(const NodeType& type);
  [[nodiscard]] Plan made_plan(const NodeType& type) const;
  void add_script_pairs(const NodeType& type, Plan& made) const;
  void add_own_pairs(const NodeType& type, Plan& made) const;
  [[nodiscard]] bool holds_written_node(const SceneGraph& scene, const FieldValue& value);
  [[nodiscard]] const FieldValue& written_value(const Node& node, const Pair& pair, WrittenNode& written) const;
  void report_lost_fields(const Node& node, const Plan& plan);

  Language language_;
  MovedUrls moved_urls_;
  PrintLosses& losses_;
  std::unordered_map<const NodeType*, Plan> plans_;
  std::unordered_set<const NodeType*> fallbacks_;
};

}  // namespace gs::vrml
