#pragma once

#include "base/noncopyable.h"
#include "vrml/scene/node_type.h"
#include "vrml/scene/x3d/language.h"
#include "vrml/scene/x3d/x3d_statements.h"

#include <cstdint>
#include <forward_list>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gs::vrml {

class SceneGraph;

/// ROUTE from.event_out TO to.event_in (VRML97 4.10.2). The types of both nodes own the declarations.
struct Route {
  NodeId from, to;
  const InterfaceDeclaration* event_out = nullptr;
  const InterfaceDeclaration* event_in = nullptr;
  friend bool operator==(const Route&, const Route&) = default;
};

/// Statement at the top level of a file. Printing preserves the order of statements.
struct Statement {
  enum class Kind : std::uint8_t { node, prototype, route };
  Kind kind;
  NodeId node;                     // for Kind::node
  const NodeType* type = nullptr;  // for Kind::prototype: a PROTO or EXTERNPROTO
  Route route;                     // for Kind::route
};

/// Source of a text's bytes. This room only stores it and compares pointers. app/world sets it from net::Origin.
struct TextSource {
  std::string url;                 // URL after redirects; for data: URLs, the URL of the enclosing text
  std::uint8_t address_space = 0;  // net::AddressSpace of the host
};

/// Text in which nodes were written: a file, or text that is read into a running world. Contains its statements, and
/// everything that its nodes need besides their values. Refers to nodes only by id.
class SourceText : NonCopyable {
 public:
  /// `file_name` identifies the text in diagnostics.
  explicit SourceText(std::string file_name);
  ~SourceText();

  [[nodiscard]] const std::string& file_name() const { return file_name_; }
  /// Returns the text of the file that requested this text. For a run-time text, this is the file of the requesting
  /// Script. For a file, returns the text itself. The result lives as long as its scene.
  [[nodiscard]] const SourceText& origin() const { return origin_ ? *origin_ : *this; }
  /// Returns the source of the bytes. It determines access rights and the base of relative URLs. A text that a Script
  /// computed has the source of the Script. Returns null if the source was not set.
  [[nodiscard]] const std::shared_ptr<const TextSource>& source() const { return source_; }
  void set_source(std::shared_ptr<const TextSource> source) { source_ = std::move(source); }
  /// Returns the language of the text. A text that a Script requested has the language of the Script's file, unless its
  /// header states another one.
  [[nodiscard]] Language language() const { return language_; }
  /// Returns ten times the version of the language: 20 for VRML97, 30 to 40 for X3D.
  [[nodiscard]] int version() const { return version_; }
  void set_language(Language language, int version) { language_ = language, version_ = version; }
  /// Reports whether a Script computed this text (createVrmlFromString). Returns false if it was read from a URL.
  [[nodiscard]] bool is_computed() const { return computed_; }
  /// Returns the X3D statements of the text. They are empty for VRML97.
  [[nodiscard]] const X3DStatements& x3d() const;
  [[nodiscard]] X3DStatements& x3d();
  /// Returns the top-level nodes.
  [[nodiscard]] const MFNode& roots() const { return roots_; }
  [[nodiscard]] std::vector<Statement>& statements() { return statements_; }
  [[nodiscard]] const std::vector<Statement>& statements() const { return statements_; }
  /// Appends a top-level node to `roots` and to the statements.
  void add_root(NodeId id);
  /// Adds the type of a PROTO, an EXTERNPROTO or a Script. It lives as long as the text.
  NodeType& add_type(std::unique_ptr<NodeType> type);
  [[nodiscard]] const std::vector<std::unique_ptr<NodeType>>& types() const { return types_; }
  /// Stores a scene with PROTOs that EXTERNPROTOs of this text use. It lives as long as the text.
  SceneGraph& attach_library(std::unique_ptr<SceneGraph> library);

 protected:
  friend class SceneGraph;
  friend class SceneTexts;
  std::string file_name_;
  const SourceText* origin_ = nullptr;
  std::shared_ptr<const TextSource> source_;
  bool computed_ = false;
  Language language_ = Language::vrml97;
  int version_ = 20;
  std::unique_ptr<X3DStatements> x3d_;  // null if there are none
  std::forward_list<std::string> names_;
  MFNode roots_;
  std::vector<Statement> statements_;
  std::vector<std::unique_ptr<NodeType>> types_;
  std::vector<std::unique_ptr<SceneGraph>> libraries_;
};

}  // namespace gs::vrml
