#include "vrml/scene/prototype.h"

#include "vrml/syntax/parser.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

using namespace gs;
using namespace gs::vrml;

namespace {

std::unique_ptr<SceneGraph> scene_of(const std::string& body) {
  auto scene = std::make_unique<SceneGraph>("text.wrl");
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\n" + body, *scene, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics.entries()) INFO(diagnostic.text());
  CHECK(diagnostics.errors() == 0);
  return scene;
}

const char* const kBall = R"(
PROTO Ball [ field SFFloat size 3 field SFColor tint 0 1 0 field MFNode extra [ Shape { } ] exposedField SFVec3f at 1 2 3 ] {
  Transform { translation IS at children [
    Shape { appearance Appearance { material Material { diffuseColor IS tint } } geometry Sphere { radius IS size } }
    Group { children IS extra } ] }
  DEF Clock TimeSensor { } DEF Path PositionInterpolator { } ROUTE Clock.fraction_changed TO Path.set_fraction
})";

NodeId child(const SceneGraph& scene, NodeId node, std::size_t i) { return scene.get<MFNode>(node, "children")[i]; }

}  // namespace

TEST_CASE("gives each instance its own nodes, with the values of IS") {
  const auto scene = scene_of(std::string(kBall) + "Ball { size 5 } Ball { tint 1 0 0 extra [ ] at 7 8 9 }");
  const NodeId first = scene->resolve_as(scene->roots()[0], NodeKind::transform);
  const NodeId second = scene->resolve_as(scene->roots()[1], NodeKind::transform);
  REQUIRE(first);
  REQUIRE(second);
  CHECK(first != second);
  CHECK(scene->get<SFVec3f>(first, "translation") == SFVec3f(1, 2, 3));
  CHECK(scene->get<SFVec3f>(second, "translation") == SFVec3f(7, 8, 9));
  CHECK(scene->get<SFFloat>(scene->get<SFNode>(child(*scene, first, 0), "geometry"), "radius") == 5);
  CHECK(scene->get<SFFloat>(scene->get<SFNode>(child(*scene, second, 0), "geometry"), "radius") == 3);
  const NodeId material = scene->get<SFNode>(scene->get<SFNode>(child(*scene, second, 0), "appearance"), "material");
  CHECK(scene->get<SFColor>(material, "diffuseColor") == Color{1, 0, 0});
  CHECK(scene->get<MFNode>(child(*scene, first, 1), "children").size() == 1);
  CHECK(scene->get<MFNode>(child(*scene, second, 1), "children").empty());
  CHECK(scene->routes().size() == 2);
  CHECK(scene->routes()[0].from != scene->routes()[1].from);
  CHECK(scene->node(scene->routes()[1].from).type->name == "TimeSensor");
}

TEST_CASE("resolves an instance to its first node, through nested instances") {
  const auto scene = scene_of(
      R"(PROTO A [ field SFFloat r 1 ] { Sphere { radius IS r } } PROTO B [ field SFFloat q 2 ] { A { r IS q } }
                                 PROTO C [ ] { B { q 9 } } Shape { geometry C { } })");
  const NodeId geometry = scene->get<SFNode>(scene->roots()[0], "geometry");
  CHECK(scene->node(geometry).type->name == "C");
  const NodeId sphere = scene->resolve(geometry);
  REQUIRE(sphere);
  REQUIRE(scene->node(sphere).type->name == "Sphere");
  CHECK(scene->get<SFFloat>(sphere, "radius") == 9);
  CHECK_FALSE(scene->resolve_as(geometry, NodeKind::point_set));
}

TEST_CASE("reports a declaration of an EXTERNPROTO that its PROTO does not have (4.9.2)") {
  const auto library =
      scene_of("PROTO P [ eventIn SFBool a eventOut SFBool b field SFBool c TRUE exposedField SFBool d TRUE ] { }");
  const auto odd = [&](const std::string& declarations) {
    const auto scene = scene_of("EXTERNPROTO P [ " + declarations + " ] \"lib.wrl\"");
    const InterfaceDeclaration* found = unlike_prototype(*scene->types().front(), *find_prototype(*library, "P"));
    return found ? found->name : std::string();
  };
  CHECK(odd("").empty());
  CHECK(odd("exposedField SFBool d field SFBool c eventOut SFBool b eventIn SFBool a").empty());
  CHECK(odd("field SFBool d").empty());
  CHECK(odd("eventIn SFBool a eventIn SFBool set_d") == "set_d");
  CHECK(odd("eventIn SFTime a") == "a");
  CHECK(odd("eventIn SFBool b") == "b");
  CHECK(odd("exposedField SFBool c") == "c");
}

TEST_CASE("takes body and defaults of an EXTERNPROTO from a PROTO of another scene") {
  auto library = scene_of(kBall);
  const auto scene = scene_of(R"(EXTERNPROTO Ball [ field SFFloat size field MFNode extra ] "lib.wrl#Ball"
                                 PROTO Two [ field SFFloat s 4 ] { Group { children [ Ball { size IS s } Ball { } ] } }
                                 Ball { } Ball { size 8 } Two { })");
  const NodeType* source = find_prototype(*library, "Ball");
  REQUIRE(source);
  CHECK(find_prototype(*library, "") == source);
  CHECK(find_prototype(*library, "Cube") == nullptr);
  NodeType* external = nullptr;
  for (const auto& type : scene->types())
    if (type->kind == NodeType::Kind::external_prototype) external = type.get();
  REQUIRE(external);
  CHECK_FALSE(scene->resolve(scene->roots()[0]));
  scene->attach_library(std::move(library));
  REQUIRE(resolve_external(*scene, *external, *source));

  const auto radius = [&](NodeId ball) {
    const NodeId transform = scene->resolve_as(ball, NodeKind::transform);
    REQUIRE(transform);
    CHECK(scene->get<SFVec3f>(transform, "translation") ==
          SFVec3f(1, 2, 3));  // the PROTO's own interface, not in the EXTERNPROTO
    const MFNode extra = scene->get<MFNode>(child(*scene, transform, 1), "children");
    REQUIRE(extra.size() == 1);
    CHECK(scene->node(extra[0]).type->name == "Shape");
    return scene->get<SFFloat>(scene->get<SFNode>(child(*scene, transform, 0), "geometry"), "radius");
  };
  CHECK(radius(scene->roots()[0]) == 3);
  CHECK(radius(scene->roots()[1]) == 8);
  const NodeId two = scene->resolve_as(scene->roots()[2], NodeKind::group);
  CHECK(radius(child(*scene, two, 0)) == 4);
  CHECK(radius(child(*scene, two, 1)) == 3);
}

TEST_CASE("nests ten thousand PROTOs without a deep stack") {
  std::string text = "PROTO P0 [ ] { Group { } }\n";
  for (int i = 1; i < 10000; ++i)
    text += "PROTO P" + std::to_string(i) + " [ ] { P" + std::to_string(i - 1) + " { } }\n";
  const auto scene = scene_of(text + "P9999 { }");
  CHECK(scene->resolve_as(scene->roots()[0], NodeKind::group));
}

TEST_CASE("keeps the file of origin of nodes and URLs, through EXTERNPROTO and IS") {
  auto library = std::make_unique<SceneGraph>("lib.wrl");
  Diagnostics diagnostics;
  (void)parse(R"(#VRML V2.0 utf8
                 PROTO Inner [ field MFString i "inner.png" ] { ImageTexture { url IS i } }
                 PROTO Outer [ field MFString own "default.png" field MFString given "default.png" ] {
                   Group { children [ ] } Inner { } Inner { i "written.png" } Inner { i IS own } Inner { i IS given } })",
              *library, diagnostics);
  const auto scene = scene_of(R"(EXTERNPROTO Outer [ field MFString own field MFString given ] "lib.wrl#Outer"
                  Outer { given "world.png" } ImageTexture { url "here.png" })");
  const SourceText* const written = library.get();
  const NodeType* const source = find_prototype(*library, "Outer");
  REQUIRE(source);
  NodeType* external = nullptr;
  for (const auto& type : scene->types())
    if (type->kind == NodeType::Kind::external_prototype) external = type.get();
  REQUIRE(external);
  scene->attach_library(std::move(library));
  REQUIRE(resolve_external(*scene, *external, *source));
  std::vector<std::pair<std::string, const SourceText*>> seen;
  for (std::uint32_t i = 1; i <= scene->nodes().count(); ++i) {
    const NodeId id = scene->nodes().id_at(i);
    if (scene->node(id).type->name != "ImageTexture") continue;
    const std::string url(scene->get<MFString>(id, "url")[0].view());
    CHECK(scene->node(id).text == (url == "here.png" ? scene.get() : written));
    seen.emplace_back(url, &scene->nodes().text_of(id, scene->node(id).type->find_field("url")->slot));
  }
  std::sort(seen.begin(), seen.end());
  const std::vector<std::pair<std::string, const SourceText*>> expected = {{"default.png", written},
                                                                           {"here.png", scene.get()},
                                                                           {"inner.png", written},
                                                                           {"world.png", scene.get()},
                                                                           {"written.png", written}};
  CHECK(seen == expected);
  const NodeId instance = scene->roots()[0];
  CHECK(&text_of_field(*scene, instance, *external->find_field("given")) == scene.get());
  CHECK(&text_of_field(*scene, instance, *external->find_field("own")) == written);
}
