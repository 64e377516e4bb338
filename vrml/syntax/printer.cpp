#include "vrml/syntax/printer.h"

#include "vrml/printing/print_scene.h"
#include "vrml/printing/value_text.h"

#include <algorithm>
#include <string>

namespace gs::vrml {

std::string print(const SceneGraph& scene) { return printed_scene(scene, {own_grammar(scene)}); }

void print(const SceneGraph& scene, const std::function<bool(std::string_view)>& write) {
  print_scene(scene, {own_grammar(scene)}, write);
}

void print_value(std::string& out, const FieldValue& value, const SceneGraph& scene) {
  const auto node_text = [&](NodeId id) {
    if (!scene.contains(id)) return std::string("NULL");
    const Node& node = scene.node(id);
    return node.name.empty() ? node.type->name : std::string(node.name);
  };
  TextOutput output([&](std::string_view piece) {
    out += piece;
    return true;
  });
  std::visit(
      [&](const auto& v) {
        using T = std::decay_t<decltype(v)>;
        using Element = ElementOf<T>;
        if constexpr (std::is_same_v<T, SFNode>) {
          output.text += node_text(v);
        } else if constexpr (requires { v.span(); }) {
          output.text += "[ ";
          for (std::size_t i = 0; i < v.size(); ++i) {
            if (i) output.text += ", ";
            if constexpr (std::is_same_v<T, MFNode>)
              output.text += node_text(v[i]);
            else
              append_element<Notation::classic, Element>(output, v[i], true);
          }
          output.text += v.empty() ? "]" : " ]";
        } else {
          append_element<Notation::classic, Element>(output, element_in(v), false);
        }
      },
      value);
  output.flush();
}

std::string print_interface(const NodeType& type) {
  static const SceneGraph nothing;
  std::string out;
  for (const InterfaceDeclaration& declaration : type.interfaces) {
    if (declaration.of_other_browsers) continue;
    std::string line = "  " + std::string(name_of(declaration.access));
    line.resize(std::max<std::size_t>(line.size() + 1, 15), ' ');
    line += name_of(declaration.type);
    line.resize(std::max<std::size_t>(line.size() + 1, 26), ' ');
    line += declaration.name;
    if (declaration.slot >= 0) {
      line.resize(std::max<std::size_t>(line.size() + 1, 43), ' ');
      print_value(line, declaration.initial, nothing);
    }
    if (!declaration.range.empty()) {
      line.resize(std::max<std::size_t>(line.size() + 1, 60), ' ');
      line += "# " + declaration.range;
    }
    out += line + '\n';
  }
  return out;
}

}  // namespace gs::vrml
