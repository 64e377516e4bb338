#pragma once

#include "vrml/scene/node_type.h"

#include <cstdint>
#include <forward_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::vrml {

class SceneGraph;

/// ROUTE from.event_out TO to.event_in (VRML97 4.10.2). The types of the nodes own the declarations.
struct Route {
  NodeId from, to;
  const InterfaceDeclaration* event_out = nullptr;
  const InterfaceDeclaration* event_in = nullptr;
  friend bool operator==(const Route&, const Route&) = default;
};

/// Statement of a file; printing keeps their order.
struct Statement {
  enum class Kind : std::uint8_t { node, prototype, route };
  Kind kind;
  NodeId node;                     // Kind::node
  const NodeType* type = nullptr;  // Kind::prototype: PROTO or EXTERNPROTO
  Route route;                     // Kind::route
};

/// Source of a text's bytes. This room only stores it and compares pointers; app/world fills it from net::Origin.
struct TextSource {
  std::string url;                 // after redirects; that of the enclosing text for data: URLs
  std::uint8_t address_space = 0;  // net::AddressSpace of the host
};

/// Text that nodes were written in: a file, or text read into a running world. Holds its statements, and everything
/// that its nodes need besides their values. Refers to nodes only by id.
class SourceText {
 public:
  /// `file_name` identifies this text in diagnostics.
  explicit SourceText(std::string file_name);
  ~SourceText();
  SourceText(const SourceText&) = delete;
  SourceText& operator=(const SourceText&) = delete;

  [[nodiscard]] const std::string& file_name() const { return file_name_; }
  /// Returns the text of the file on behalf of which this text was read: for a run-time text, that of the requesting
  /// Script. It lives as long as its scene. Returns the text itself for a file.
  [[nodiscard]] const SourceText& origin() const { return origin_ ? *origin_ : *this; }
  /// Returns the source of the bytes, which determines access rights and the base of relative URLs. A text that a
  /// Script wrote has the source of the Script. Null if unset.
  [[nodiscard]] const std::shared_ptr<const TextSource>& source() const { return source_; }
  void set_source(std::shared_ptr<const TextSource> source) { source_ = std::move(source); }
  /// Reports whether a Script computed this text (createVrmlFromString), as opposed to a text read from a URL.
  [[nodiscard]] bool is_computed() const { return computed_; }
  /// Returns the top-level nodes.
  [[nodiscard]] const MFNode& roots() const { return roots_; }
  [[nodiscard]] std::vector<Statement>& statements() { return statements_; }
  [[nodiscard]] const std::vector<Statement>& statements() const { return statements_; }
  /// Appends a top-level node to `roots` and to the statements.
  void add_root(NodeId id);
  /// Adds a PROTO, EXTERNPROTO or Script type that lives as long as the text.
  NodeType& add_type(std::unique_ptr<NodeType> type);
  [[nodiscard]] const std::vector<std::unique_ptr<NodeType>>& types() const { return types_; }
  /// Keeps a scene alive that provides PROTOs through EXTERNPROTO.
  SceneGraph& attach_library(std::unique_ptr<SceneGraph> library);

 protected:
  friend class SceneGraph;
  friend class RunTimeText;
  std::string file_name_;
  const SourceText* origin_ = nullptr;
  std::shared_ptr<const TextSource> source_;
  bool computed_ = false;
  std::forward_list<std::string> names_;
  MFNode roots_;
  std::vector<Statement> statements_;
  std::vector<std::unique_ptr<NodeType>> types_;
  std::vector<std::unique_ptr<SceneGraph>> libraries_;
};

}  // namespace gs::vrml
