#include "app/commands/commands.h"
#include "vrml/node_type.h"
#include "vrml/printer.h"

#include <cstdio>

namespace gs::app {
namespace {

void print_markdown(const vrml::NodeType& type) {
  std::printf("## %s\n%s\n\n| access | type | name | default | range |\n| --- | --- | --- | --- | --- |\n",
              type.name.c_str(),
              (type.clause.front() == '6' ? "VRML97 " + type.clause : "An extension of " + type.clause).c_str());
  const vrml::SceneGraph nothing;
  for (const vrml::InterfaceDeclaration& declaration : type.interfaces) {
    std::string value;
    if (declaration.slot >= 0) vrml::print_value(value, declaration.initial, nothing);
    std::printf("| %s | %s | %s | %s | %s |\n", std::string(name_of(declaration.access)).c_str(),
                std::string(name_of(declaration.type)).c_str(), declaration.name.c_str(), value.c_str(),
                declaration.range.c_str());
  }
  std::printf("\n");
}

}  // namespace

int run_nodes(const Options& options) {
  if (!options.markdown) std::printf("#VRML V2.0 utf8\n");
  for (const auto& type : vrml::built_in_node_types()) {
    if (options.markdown) {
      print_markdown(*type);
    } else {
      std::printf("\n# %s\nPROTO %s [\n%s] {\n}\n", type->clause.c_str(), type->name.c_str(),
                  vrml::print_interface(*type).c_str());
    }
  }
  return kDone;
}

int run_man(const Options&) {
  std::fputs(manual_page().c_str(), stdout);
  return kDone;
}

}  // namespace gs::app
