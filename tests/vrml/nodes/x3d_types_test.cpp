#include "vrml/scene/node_type.h"
#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"

#include <expat.h>
#include <catch2/catch.hpp>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

// Tests of the node types of X3D.
namespace gs::vrml {
namespace {

const NodeType& x3d_type(std::string_view name) {
  const NodeType* type = built_in_node_type(Language::x3d, name);
  REQUIRE(type);
  return *type;
}

/// Field of a node in the X3D Unified Object Model.
struct ModelField {
  std::string type, access, accepts;
};
/// Concrete node of the X3D Unified Object Model.
struct ModelNode {
  std::string component, container_field;
  int level = 0;
  std::map<std::string, ModelField> fields;
};
/// Reader of the concrete nodes of the X3D Unified Object Model.
struct ModelReader {
  std::map<std::string, ModelNode> nodes;
  ModelNode* node = nullptr;
  int depth = 0, node_depth = 0;

  static void begin(void* self, const XML_Char* name, const XML_Char** pairs) {
    static_cast<ModelReader*>(self)->begin_element(name, pairs);
  }
  static void end(void* self, const XML_Char*) {
    auto& reader = *static_cast<ModelReader*>(self);
    if (--reader.depth < reader.node_depth) reader.node = nullptr;
  }

 private:
  void begin_element(const std::string& name, const XML_Char** pairs) {
    std::map<std::string, std::string> given;
    for (; *pairs; pairs += 2) given[pairs[0]] = pairs[1];
    ++depth;
    if (name == "ConcreteNode") {
      node = &nodes[given["name"]];
      node_depth = depth;
    }
    if (!node) return;
    if (name == "componentInfo" && node->component.empty()) {
      node->component = given["name"];
      node->level = std::stoi(given["level"]);
    }
    if (name == "containerField") node->container_field = given["default"];
    if (name == "field")
      node->fields[given["name"]] = {given["type"], given["accessType"], given["acceptableNodeTypes"]};
  }
};

std::filesystem::path model_file() {
  const char* set = std::getenv("GHOSTSPACE_SHARED");
  return (set ? std::filesystem::path(set) : std::filesystem::path(GHOSTSPACE_TESTS) / "../../shared") /
         "spec/x3d-uom-4.0.xml";
}

// Reports whether a type allows all uses of an interface that an access type of X3D allows.
bool allows(AccessType own, const std::string& access) {
  if (own == AccessType::exposedField) return access == "inputOutput" || access == "initializeOnly";
  return (own == AccessType::field && access == "initializeOnly") ||
         (own == AccessType::eventIn && access == "inputOnly") ||
         (own == AccessType::eventOut && access == "outputOnly");
}

}  // namespace

TEST_CASE("keeps the interfaces of VRML97 in the same slots of the X3D type of this name", "[x3d]") {
  for (const auto& type : built_in_node_types()) {
    const NodeType& other = x3d_type(type->name);
    if (is_extension(type->clause)) continue;
    CAPTURE(type->name);
    CHECK(other.read_as == type->read_as);
    for (const InterfaceDeclaration& each : type->interfaces) {
      if (each.of_other_browsers) continue;
      const InterfaceDeclaration* same = other.find(each.name);
      CAPTURE(each.name);
      REQUIRE(same);
      CHECK(same->type == each.type);
      CHECK(same->slot == each.slot);
    }
  }
}

TEST_CASE("finds renamed interfaces by both names in X3D only", "[x3d]") {
  for (const auto& [type, old_name, new_name] : {std::array{"Switch", "choice", "children"},
                                                 {"LOD", "level", "children"},
                                                 {"Collision", "collide", "enabled"}}) {
    CAPTURE(type);
    REQUIRE(x3d_type(type).find_field(old_name));
    CHECK(x3d_type(type).find_field(new_name) == x3d_type(type).find_field(old_name));
    CHECK(name_in(Language::x3d, *x3d_type(type).find_field(old_name)) == new_name);
    CHECK(name_in(Language::vrml97, *x3d_type(type).find_field(old_name)) == old_name);
  }
  CHECK(!built_in_node_type("Switch")->find_field("children"));
  CHECK(x3d_type("Collision").find_event_in("set_enabled") == x3d_type("Collision").find("collide"));
}

TEST_CASE("accepts the types that a field lists, and types that derive from them", "[x3d]") {
  const InterfaceDeclaration& geometry = *x3d_type("Shape").find("geometry");
  CHECK(accepts(geometry, x3d_type("IndexedFaceSet")));
  CHECK(accepts(geometry, x3d_type("Disk2D")));
  CHECK(!accepts(geometry, x3d_type("Material")));
  CHECK(accepts(*x3d_type("Appearance").find("texture"), x3d_type("PixelTexture")));
  CHECK(!accepts(*x3d_type("Appearance").find("textureTransform"), x3d_type("PixelTexture")));
  CHECK(accepts(*x3d_type("Group").find("children"), x3d_type("Viewpoint")));
}

TEST_CASE("reads an X3D node in a VRML97 text with one warning", "[x3d]") {
  SceneGraph scene("a.wrl");
  Diagnostics diagnostics;
  parse("#VRML V2.0 utf8\nShape { geometry Arc2D { radius 2 } } Shape { geometry Arc2D { } }", scene,
        diagnostics);
  CHECK(scene.nodes().count() == 4);
  CHECK(diagnostics.errors() == 0);
  CHECK(diagnostics.warnings() == 1);
}

TEST_CASE("has each node, field and component of the X3D Unified Object Model", "[x3d]") {
  std::ifstream file(model_file(), std::ios::binary);
  if (!file) {
    WARN("skipped: needs " << model_file());
    return;
  }
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  ModelReader model;
  XML_Parser parser = XML_ParserCreate(nullptr);
  XML_SetUserData(parser, &model);
  XML_SetElementHandler(parser, ModelReader::begin, ModelReader::end);
  REQUIRE(XML_Parse(parser, text.data(), static_cast<int>(text.size()), 1) == XML_STATUS_OK);
  XML_ParserFree(parser);
  REQUIRE(model.nodes.size() == 260);
  // Parts of the XML encoding and of its validation, which are no fields.
  const std::set<std::string> no_fields{"IS",    "DEF",   "USE",        "class",     "id",
                                        "style", "field", "fieldValue", "sourceCode"};
  for (const auto& [name, node] : model.nodes) {
    if (name == "ProtoInstance") continue;
    CAPTURE(name);
    const NodeType& type = x3d_type(name);
    REQUIRE(type.language == Language::x3d);
    CHECK(type.component == node.component);
    CHECK(type.level == node.level);
    CHECK(type.container_field == node.container_field);
    for (const auto& [field_name, field] : node.fields) {
      if (no_fields.contains(field_name) || !field_type_named(field.type)) continue;
      CAPTURE(field_name);
      const InterfaceDeclaration* own = type.find(field_name);
      REQUIRE(own);
      CHECK(name_of(own->type) == field.type);
      CHECK(allows(own->access, field.access));
    }
  }
}

}  // namespace gs::vrml
