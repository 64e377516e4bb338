#pragma once

#include "vrml/x3d/node_place.h"
#include "vrml/x3d/value_text.h"

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace gs::vrml::x3d {

/// Attribute of an element.
struct Attribute {
  std::string_view name, value;
  SourceLocation location;  // of the value
};

/// Kind of an element. Each element that is not listed here is a node.
enum class ElementKind : std::uint8_t {
  x3d,
  head,
  component,
  meta,
  unit,
  scene,
  prototype,
  prototype_interface,
  prototype_body,
  external_prototype,
  instance,  // ProtoInstance
  field,
  field_value,
  is,
  connect,
  route,
  import_node,
  export_node,
  node,
};
[[nodiscard]] ElementKind kind_of(std::string_view element);

/// Builder of a scene from the elements of X3D, for the XML and JSON encodings (ISO/IEC 19776-1 and -5).
///
/// Each begin() needs an end(). Nodes are put into the field that `containerField` names, or into the field that takes
/// nodes of their type. Elements and attributes may come from untrusted text. One thread.
class ElementBuilder {
 public:
  /// Sets the language of the text of `scene` to X3D. `sink` must outlive the builder.
  explicit ElementBuilder(SceneSink& sink);

  /// Begins an element. `attributes` select its node or interface: DEF, USE, containerField, name and so on. Other
  /// attributes are ignored.
  void begin(SourceName element, std::span<const Attribute> attributes);
  /// Returns storage for the value of an attribute of the innermost element, with the type of its field. Returns null
  /// if the attribute has no value to store; problems are reported. After storing, call value_given().
  [[nodiscard]] FieldValue* value_of(SourceName attribute);
  void value_given();
  /// Names the innermost node after other members.
  void name_node(SourceName name);
  /// Reports whether text is a part of the innermost element: the program of a Script or the source of a shader.
  [[nodiscard]] bool takes_text() const;
  /// Appends text to the program of the innermost element.
  void text(std::string_view text, SourceLocation location);
  void end();

  /// Ends all open elements, and adds waiting ROUTEs.
  void finish();

  [[nodiscard]] std::size_t depth() const { return frames_.size(); }
  /// Returns the position of the innermost open element.
  [[nodiscard]] SourceLocation open_location() const;
  [[nodiscard]] std::vector<NodeId> open_nodes() const;
  /// Reports whether an X3D or Scene element was read.
  [[nodiscard]] bool is_x3d() const { return is_x3d_; }

 private:
  /// IS connection of a node.
  struct Connection {
    std::string inner, outer;
    SourceLocation location;
  };
  /// Parts of a node that take effect at its end.
  struct ScriptParts {
    std::string text;  // program in the element
    SourceLocation text_location;
    std::vector<Connection> connections;  // IS connections of interfaces that are not declared yet
  };
  /// Open element.
  struct Frame {
    ElementKind kind = ElementKind::node;
    bool skipped = false;         // only named nodes inside the element are read
    bool interface_open = false;  // for prototype: its interface has no end yet
    bool has_body = false;        // for prototype: its body was read
    SourceLocation location;
    OpenNode node;                                  // for node and instance
    NodeId owner;                                   // for field: its Script
    NodeType* declaring = nullptr;                  // type that `field` elements extend
    std::unique_ptr<InterfaceDeclaration> pending;  // for field; for external_prototype, its url
    const InterfaceDeclaration* field = nullptr;    // for field_value
    std::unique_ptr<ScriptParts> script;
  };

  void begin_node(SourceName element, std::span<const Attribute> attributes, Frame& frame);
  void begin_prototype(SourceName element, std::span<const Attribute> attributes, Frame& frame);
  void begin_body(Frame& frame);
  void begin_field(SourceName element, std::span<const Attribute> attributes, Frame& frame);
  void begin_field_value(SourceName element, std::span<const Attribute> attributes, Frame& frame);
  void begin_statement(SourceName element, std::span<const Attribute> attributes, Frame& frame);
  void connect(SourceName element, std::span<const Attribute> attributes, Frame& frame);
  void add_text_url(Frame& frame);
  void end_node(Frame& frame);
  void end_prototype(Frame& frame);
  void end_field(Frame& frame);
  [[nodiscard]] const InterfaceDeclaration* find_field(Frame& frame, SourceName attribute);
  [[nodiscard]] bool find_target(const NodeType* type, SourceName element, std::string_view container,
                                 NodeTarget& target);
  [[nodiscard]] NodeTarget target_in(Frame& parent, const InterfaceDeclaration& field, SourceName element);
  [[nodiscard]] Frame* parent() { return frames_.empty() ? nullptr : &frames_.back(); }
  void skip_misplaced(SourceName element, Frame& frame);
  [[nodiscard]] static std::string_view value_in(std::span<const Attribute> attributes, std::string_view name);

  SceneSink& sink_;
  std::vector<Frame> frames_;
  RecentPlaces places_;
  FieldValue discarded_ = MFNode{};              // nodes without a place
  const InterfaceDeclaration* given_ = nullptr;  // field of the last value_of()
  SourceName given_name_;
  std::unordered_set<std::string> said_;  // element names that were reported
  bool is_x3d_ = false;
};

}  // namespace gs::vrml::x3d
