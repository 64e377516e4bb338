#include "vrml/scene/node_type.h"

#include "vrml/scene/scene_graph.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/printer.h"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

using namespace gs;

using namespace gs::vrml;

namespace {

std::filesystem::path shared_folder() {
  if (const char* folder = std::getenv("GHOSTSPACE_SHARED")) return folder;
  return std::filesystem::path(GHOSTSPACE_TESTS) / "../../shared";
}

std::string squeezed(std::string text) {
  text.erase(std::remove(text.begin(), text.end(), ' '), text.end());
  return text;
}

// Restores the signs for infinity and pi, which are missing in the JSON file.
std::string repaired(const std::string& node, std::string range) {
  range = squeezed(range);
  if (range == "seeSoSFImage") return "";
  if (node == "CylinderSensor" && range == "[-2,2]") return "[-2pi,2pi]";
  if (node == "CylinderSensor" && range == "(0,/2)") return "(0,pi/2)";
  const auto replace = [&](const std::string& what, const std::string& with) {
    for (std::size_t at = 0; (at = range.find(what, at)) != std::string::npos; at += with.size())
      range.replace(at, what.size(), with);
  };
  replace("(-,)", "(-inf,inf)");
  replace(",)", ",inf)");
  return range;
}

}  // namespace

TEST_CASE("finds the 54 node types of VRML97 by name") {
  std::size_t standard = 0;
  for (const auto& type : built_in_node_types()) {
    CHECK(built_in_node_type(type->name) == type.get());
    if (type->clause.starts_with("6.")) ++standard;
  }
  CHECK(standard == 54);
  CHECK(built_in_node_type("Boxx") == nullptr);
  CHECK(built_in_node_type("Box")->clause == "6.7");
  CHECK(built_in_node_type("WorldInfo")->clause == "6.55");
}

TEST_CASE("matches the interfaces of the standard, row by row") {
  const auto path = shared_folder() / "spec/vrml97-nodes.json";
  if (!std::filesystem::exists(path)) {
    WARN("skipped: " << path << " is not there");
    return;
  }
  std::ifstream file(path);
  const auto facts = nlohmann::json::parse(file);
  CHECK(facts.size() == 54);
  std::size_t rows = 0;
  for (const auto& [name, interfaces] : facts.items()) {
    const NodeType* type = built_in_node_type(name);
    REQUIRE(type);
    const auto others = std::count_if(type->interfaces.begin(), type->interfaces.end(),
                                      [](const InterfaceDeclaration& one) { return one.of_other_browsers; });
    CHECK(type->interfaces.size() - static_cast<std::size_t>(others) == interfaces.size());
    for (const auto& row : interfaces) {
      ++rows;
      const std::string field = row["name"];
      INFO(name << "." << field);
      const InterfaceDeclaration* declaration = type->find(field);
      REQUIRE(declaration);
      CHECK(std::string(name_of(declaration->access)) == row["access"]);
      CHECK(std::string(name_of(declaration->type)) == row["type"]);
      CHECK(squeezed(declaration->range) == repaired(name, row["range"]));
      if (declaration->slot < 0) continue;
      // The reader must read the standard's default to an equal value.
      NodeType standard;
      REQUIRE(parse_interface("field " + std::string(row["type"]) + " x " + std::string(row["default"]), standard));
      CHECK((declaration->initial == standard.interfaces.front().initial));
    }
  }
  CHECK(rows == 312);
}

TEST_CASE("finds events of exposedFields under set_x and x_changed") {
  const NodeType& transform = *built_in_node_type("Transform");
  CHECK(transform.find_event_in("set_translation") == transform.find("translation"));
  CHECK(transform.find_event_in("translation") == transform.find("translation"));
  CHECK(transform.find_event_out("translation_changed") == transform.find("translation"));
  CHECK(transform.find_event_in("addChildren") == transform.find("addChildren"));
  CHECK(transform.find_event_out("addChildren") == nullptr);
  CHECK(transform.find_event_in("translation_changed") == nullptr);
  CHECK(transform.find_event_in("bboxSize") == nullptr);
  CHECK(built_in_node_type("TimeSensor")->find_event_out("fraction_changed")->access == AccessType::eventOut);
  CHECK(transform.find_field("addChildren") == nullptr);
}

TEST_CASE("prints and parses a default node of every type without a change") {
  SceneGraph scene;
  for (const auto& type : built_in_node_types())
    if (type->kind != NodeType::Kind::script) scene.add_root(scene.create(*type));
  const std::string printed = print(scene);
  SceneGraph again;
  Diagnostics diagnostics;
  CHECK(parse(printed, again, diagnostics) == ParseOutcome::complete);
  CHECK(diagnostics.errors() == 0);
  CHECK(again.nodes().count() == scene.nodes().count());
  CHECK(print(again) == printed);
}

TEST_CASE("parses printed interfaces to equal declarations") {
  for (const auto& type : built_in_node_types()) {
    if (type->kind == NodeType::Kind::script) continue;
    NodeType again;
    REQUIRE(parse_interface(print_interface(*type), again));
    // Events of other browsers are at the end, and are not printed.
    std::size_t printed = type->interfaces.size();
    while (printed > 0 && type->interfaces[printed - 1].of_other_browsers) --printed;
    REQUIRE(again.interfaces.size() == printed);
    for (std::size_t i = 0; i < again.interfaces.size(); ++i) {
      CHECK(again.interfaces[i].name == type->interfaces[i].name);
      CHECK((again.interfaces[i].initial == type->interfaces[i].initial));
    }
  }
}

TEST_CASE("parses, prints and routes the QNV node like any other") {
  const NodeType* type = built_in_node_type("QNV");
  REQUIRE(type);
  CHECK(type->clause == "GhostSpace");
  CHECK(has(type->role, Role::geometry));
  CHECK_FALSE(type->tessellator.tessellate);
  CHECK(type->find_event_out("progress_changed")->type == FieldType::SFFloat);
  CHECK(type->find_event_out("loadTime")->type == FieldType::SFTime);
  CHECK(type->find_event_in("set_detail"));
  CHECK_FALSE(type->find_event_in("set_vectors"));

  const std::string text =
      "#VRML V2.0 utf8\nDEF T TimeSensor { }\nShape { geometry DEF Q QNV { url [ \"a.qnv\" \"b.qnv\" ] detail 2 "
      "profile "
      "\"VOLUME\" transfer [ 0 0 0 0 0, 1 1 1 1 0.5 ] vectors [ 1 -2 ] bboxSize 1 2 3 } }\n"
      "ROUTE T.fraction_changed TO Q.set_detail\n";
  SceneGraph scene("q.wrl");
  Diagnostics diagnostics;
  REQUIRE(parse(text, scene, diagnostics) == ParseOutcome::complete);
  CHECK(diagnostics.entries().empty());
  REQUIRE(scene.routes().size() == 1);
  const NodeId qnv = scene.routes()[0].to;
  CHECK(scene.get<MFString>(qnv, "url").size() == 2);
  CHECK(scene.get<SFFloat>(qnv, "detail") == 2);
  CHECK(scene.get<MFFloat>(qnv, "transfer").size() == 10);
  CHECK(scene.get<MFInt32>(qnv, "vectors")[1] == -2);
  CHECK(scene.get<SFVec3f>(qnv, "bboxSize").z == 3);
  SceneGraph again("again.wrl");
  const std::string printed = print(scene);
  REQUIRE(parse(printed, again, diagnostics) == ParseOutcome::complete);
  CHECK(print(again) == printed);
}
