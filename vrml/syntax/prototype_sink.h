#pragma once

#include "base/noncopyable.h"
#include "vrml/scene/scene_graph.h"

namespace gs::vrml {

class SceneSink;
struct OpenNode;
struct SourceName;

/// Part of SceneSink for PROTO, EXTERNPROTO, IS and the interfaces of Scripts (VRML97 4.8, 4.9). Names and values may
/// come from untrusted text. One thread.
class PrototypeSink : NonCopyable {
 public:
  explicit PrototypeSink(SceneSink& sink) : sink_(sink) {}

  /// Begins the interface of a PROTO or EXTERNPROTO. After end_interface(), the grammar must call begin_body() and
  /// end_body() for a PROTO, or end_external() for an EXTERNPROTO. Only a broken declaration ends without them.
  [[nodiscard]] NodeType& begin_prototype(SourceName name, bool external);
  /// Reports whether a PROTO, EXTERNPROTO or Script may declare this interface. A second declaration of a name is not
  /// allowed.
  [[nodiscard]] bool may_declare(const NodeType& type, const InterfaceDeclaration& declaration,
                                 SourceLocation location);
  /// Adds a declaration to a PROTO or EXTERNPROTO, or to the type of the Script `script`.
  void declare(NodeType& type, NodeId script, InterfaceDeclaration declaration);
  void end_interface();
  void begin_body(NodeType& type);
  void end_body();
  void end_external(NodeType& type, MFString url);
  /// Connects a field or event of the node with IS to an interface of the PROTO (VRML97 4.8.2).
  void connect(OpenNode& node, SourceName inner, SourceName outer);

 private:
  void convert_prototype(NodeType& type);
  void add_type(NodeType& type);

  SceneSink& sink_;
};

}  // namespace gs::vrml
