#pragma once

#include "base/noncopyable.h"
#include "vrml/printing/print_losses.h"
#include "vrml/printing/text_head.h"
#include "vrml/printing/text_output.h"
#include "vrml/printing/written_node.h"
#include "vrml/printing/written_scope.h"
#include "vrml/scene/scene_graph.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace gs::vrml {

/// Walk over a scene that writes its text: statements, nodes, PROTO declarations with their bodies, and ROUTEs. A
/// derived class has the notation of one encoding; it writes each construct, and calls put_child() for nodes in fields.
/// One thread.
class ScenePrinter : NonCopyable {
 public:
  ScenePrinter(const SceneGraph& scene, NodeTranslator& translator, TextOutput& output)
      : scene_(scene), translator_(translator), output_(output) {}
  virtual ~ScenePrinter() = default;

  void print(const TextHead& head);

 protected:
  /// IMPORT inline_name.exported AS local (X3D 4.4.6.2), and EXPORT local AS exported, which has no Inline.
  struct SharedName {
    std::string_view inline_name, exported, local;
  };

  virtual void begin_text(const TextHead& head) = 0;
  virtual void end_text() = 0;
  /// Begins a top-level statement of the file or of a PROTO's body.
  virtual void begin_statement(bool first, bool is_route) = 0;
  virtual void end_statement() = 0;
  /// Writes a node with its children. `field` is the field that holds the node; empty for a statement, and in fields of
  /// Scripts and PROTOs.
  virtual void put_node(const WrittenNode& node, std::string_view field) = 0;
  virtual void put_use(const NodeType& type, std::string_view name, std::string_view field) = 0;
  virtual void put_null() = 0;
  virtual void put_prototype(const NodeType& type) = 0;
  virtual void put_route(const NamedRoute& route) = 0;
  virtual void put_import(const SharedName& shared) = 0;
  virtual void put_export(const SharedName& shared) = 0;

  [[nodiscard]] std::string& out() { return output_.text; }
  [[nodiscard]] TextOutput& output() { return output_; }
  [[nodiscard]] NodeTranslator& translator() { return translator_; }
  /// Returns the scope of the present statement.
  [[nodiscard]] const WrittenScope& scope() const { return *scope_; }
  [[nodiscard]] std::size_t levels() const { return levels_; }
  void add_levels(std::size_t count) { levels_ += count; }
  void remove_levels(std::size_t count) { levels_ -= count; }
  void start_line() { output_.start_line(levels_); }

  /// Writes the node of an SFNode field, or NULL.
  void put_child(NodeId id, std::string_view field);
  /// Calls `put` before each node of a field that the text contains, and writes the node.
  template <class Put>
  void put_children(const WrittenField& field, std::string_view name, const Put& put);
  /// Returns the default value of a declaration of a PROTO. `moved` stores the value if it differs.
  [[nodiscard]] WrittenField default_value(const NodeType& type, const InterfaceDeclaration& declaration,
                                           FieldValue& moved);
  /// Writes the statements in the body of a PROTO.
  void put_body(const NodeType& type);

 private:
  void put_scope(const SceneGraph& scene, const std::vector<Statement>& statements, const NodeType* prototype);
  void put_statement(const Statement& statement);
  void put_statement(const Route& route, bool last);
  void put_imports(const X3DStatements& statements, bool early);
  void put_shared_names(const X3DStatements& statements);

  const SceneGraph& scene_;
  NodeTranslator& translator_;
  TextOutput& output_;
  WrittenScope* scope_ = nullptr;
  bool is_empty_ = true;               // no statement of the scope was written yet
  std::vector<Route> waiting_routes_;  // ROUTEs of the scope with nodes that are not written yet
  std::size_t levels_ = 0;
  int depth_ = 0;
};

template <class Put>
void ScenePrinter::put_children(const WrittenField& field, std::string_view name, const Put& put) {
  if (field.made) {
    put();
    put_node(NodeTranslator::written(*field.made), name);
    return;
  }
  const auto put_one = [&](NodeId id) {
    if (scope_->scene().contains(id) && !translator_.is_written(scope_->scene(), id))
      return translator_.add_left_out(*scope_->scene().node(id).type);
    put();
    put_child(id, name);
  };
  if (const auto* one = std::get_if<SFNode>(field.value)) {
    put_one(*one);
  } else {
    for (const NodeId id : std::get<MFNode>(*field.value))
      if (scope_->scene().contains(id)) put_one(id);
  }
}

}  // namespace gs::vrml
