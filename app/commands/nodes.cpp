#include "app/commands/nodes.h"

#include "app/base/console.h"
#include "app/base/exit_status.h"
#include "vrml/scene/node_type.h"
#include "vrml/syntax/printer.h"

#include <string>

namespace gs::app {
namespace {

std::string as_markdown(const vrml::NodeType& type) {
  std::string text = "## " + type.name + "\n" +
                     (type.clause.front() == '6' ? "VRML97 " + type.clause : "An extension of " + type.clause) +
                     "\n\n| access | type | name | default | range |\n| --- | --- | --- | --- | --- |\n";
  const vrml::SceneGraph nothing;
  for (const vrml::InterfaceDeclaration& declaration : type.interfaces) {
    if (declaration.of_other_browsers) continue;
    std::string value;
    if (declaration.slot >= 0) vrml::print_value(value, declaration.initial, nothing);
    text.append("| ").append(name_of(declaration.access)).append(" | ").append(name_of(declaration.type));
    text.append(" | ").append(declaration.name).append(" | ").append(value);
    text.append(" | ").append(declaration.range).append(" |\n");
  }
  return text + "\n";
}

std::string as_prototype(const vrml::NodeType& type) {
  return "\n# " + type.clause + "\nPROTO " + type.name + " [\n" + vrml::print_interface(type) + "] {\n}\n";
}

}  // namespace

int run_nodes(const NodesCommand& options) {
  std::string text = options.markdown ? "" : "#VRML V2.0 utf8\n";
  for (const auto& type : vrml::built_in_node_types()) text += (options.markdown ? as_markdown : as_prototype)(*type);
  print_text(text);
  return kDone;
}

}  // namespace gs::app
