#include "vrml/events/execution.h"
#include "vrml/printing/print_scene.h"
#include "vrml/scene/imported_use.h"
#include "vrml/syntax/parser.h"
#include "vrml/syntax/scene_reader.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

using namespace gs;
using namespace gs::vrml;

namespace {

std::shared_ptr<SceneGraph> x3d_scene(const std::string& body, const std::string& name = "inner.x3dv") {
  auto scene = std::make_shared<SceneGraph>(name);
  Diagnostics diagnostics;
  (void)parse("#X3D V3.3 utf8\n" + body, *scene, diagnostics);
  for (const Diagnostic& diagnostic : diagnostics.entries()) UNSCOPED_INFO(diagnostic.text());
  CHECK(diagnostics.errors() == 0);
  return scene;
}

// Reads a printed scene, which must have no errors.
void read_again(const std::string& printed, Grammar grammar, SceneGraph& scene) {
  Diagnostics diagnostics;
  const auto reader = make_reader(grammar, scene, diagnostics);
  reader->push(printed);
  (void)reader->finish();
  CHECK(diagnostics.errors() == 0);
}

// World with an Inline, and ROUTEs from and to its exported Transform.
struct InlineWorld {
  std::shared_ptr<SceneGraph> root = x3d_scene(
      "DEF I Inline { } IMPORT I.Mover AS M\n"
      "DEF From Transform { } DEF To Transform { }\n"
      "ROUTE From.translation_changed TO M.set_translation\n"
      "ROUTE M.translation_changed TO To.set_translation\n",
      "root.x3dv");
  Execution execution{*root};

  void attach(std::shared_ptr<SceneGraph> content) {
    root->inlines().attach(root->roots()[0], std::move(content));
    execution.scenes().attach(*root);
  }
  void send(const SFVec3f& translation) {
    const NodeId from = root->roots()[1];
    REQUIRE(execution.send(*root, from, *root->node(from).type->find("translation"), translation));
    execution.cascade().begin_update();
  }
  [[nodiscard]] SFVec3f received() const { return root->get<SFVec3f>(root->roots()[2], "translation"); }
  [[nodiscard]] std::string said() {
    Diagnostics diagnostics;
    execution.routes().imports().report(diagnostics);
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics.entries()) text += diagnostic.text() + "\n";
    return text;
  }
};

}  // namespace

TEST_CASE("routes events to and from the exported node of an Inline") {
  InlineWorld world;
  world.execution.start(1000);
  world.send({1, 2, 3});
  CHECK(world.received() == SFVec3f(0));
  CHECK_FALSE(world.execution.routes().imports().find(*world.root, "M").scene);
  const auto inner = x3d_scene("DEF T Transform { } EXPORT T AS Mover");
  world.attach(inner);
  world.send({4, 5, 6});
  CHECK(inner->get<SFVec3f>(inner->roots()[0], "translation") == SFVec3f(4, 5, 6));
  CHECK(world.received() == SFVec3f(4, 5, 6));
  const ImportedNode found = world.execution.routes().imports().find(*world.root, "M");
  CHECK(found.scene == inner.get());
  CHECK(found.node == inner->roots()[0]);
  CHECK(world.execution.routes().all().size() == 2);
  CHECK(world.said().empty());
}

TEST_CASE("connects imported nodes again after the content of the Inline was replaced") {
  InlineWorld world;
  world.execution.start(1000);
  world.attach(x3d_scene("DEF T Transform { } EXPORT T AS Mover"));
  world.execution.lifetime().remove_content(*world.root, world.root->roots()[0]);
  CHECK(world.execution.routes().all().empty());
  world.send({1, 1, 1});
  CHECK(world.received() == SFVec3f(0));
  world.attach(x3d_scene("Group { } DEF Other Transform { } EXPORT Other AS Mover"));
  world.send({2, 2, 2});
  CHECK(world.received() == SFVec3f(2));
  CHECK(world.said().empty());
}

TEST_CASE("routes to a node that an Inline imports and exports again") {
  InlineWorld world;
  world.execution.start(1000);
  const auto middle = x3d_scene("DEF J Inline { } IMPORT J.Deep AS D EXPORT D AS Mover");
  world.attach(middle);
  const auto deep = x3d_scene("DEF T Transform { } EXPORT T AS Deep");
  middle->inlines().attach(middle->roots()[0], deep);
  world.execution.scenes().attach(*middle);
  world.send({7, 8, 9});
  CHECK(deep->get<SFVec3f>(deep->roots()[0], "translation") == SFVec3f(7, 8, 9));
  CHECK(world.received() == SFVec3f(7, 8, 9));
}

TEST_CASE("reports imported names and events that do not exist, once") {
  InlineWorld world;
  world.attach(x3d_scene("DEF T Transform { } EXPORT T"));
  CHECK(world.said() == "root.x3dv:2:18: warning: IMPORT names 'Mover', but inner.x3dv does not EXPORT it\n");
  world.execution.lifetime().remove_content(*world.root, world.root->roots()[0]);
  world.attach(x3d_scene("DEF T TimeSensor { } EXPORT T AS Mover"));
  CHECK(world.said() ==
        "root.x3dv:4:1: error: TimeSensor has no eventIn 'set_translation'\n"
        "root.x3dv:5:1: error: TimeSensor has no eventOut 'translation_changed'\n");
  CHECK(world.said().empty());
}

TEST_CASE("does not send nodes to another file") {
  const auto root = x3d_scene(
      "DEF I Inline { } IMPORT I.G AS G\n"
      "DEF From Group { }\n"
      "ROUTE From.children_changed TO G.set_children\n",
      "root.x3dv");
  Execution execution(*root);
  const auto inner = x3d_scene("DEF G Group { } EXPORT G");
  root->inlines().attach(root->roots()[0], inner);
  execution.scenes().attach(*root);
  Diagnostics diagnostics;
  execution.routes().imports().report(diagnostics);
  REQUIRE(diagnostics.entries().size() == 1);
  CHECK(diagnostics.entries()[0].text() ==
        "root.x3dv:4:1: error: ROUTE from MFNode 'children_changed' to MFNode 'set_children'; nodes cannot be sent to "
        "another file");
  CHECK(execution.routes().all().empty());
}

TEST_CASE("routes to the exported node of an Inline in each instance of a PROTO (X3D 4.4.6)") {
  const auto root = x3d_scene(
      "PROTO P [ inputOnly SFVec3f place ] { DEF T Transform { translation IS place children DEF I Inline { } } "
      "ROUTE T.translation_changed TO M.set_translation IMPORT I.Mover AS M } "
      "DEF A P { } DEF B P { }",
      "root.x3dv");
  Execution execution(*root);
  execution.start(1000);
  const auto inline_of = [&](std::size_t instance) {
    return root->get<MFNode>(root->resolve(root->roots()[instance]), "children")[0];
  };
  const auto inner_a = x3d_scene("DEF T Transform { } EXPORT T AS Mover"),
             inner_b = x3d_scene("DEF T Transform { } EXPORT T AS Mover");
  root->inlines().attach(inline_of(0), inner_a);
  root->inlines().attach(inline_of(1), inner_b);
  execution.scenes().attach(*root);
  const NodeId a = root->roots()[0];
  REQUIRE(execution.send(*root, a, *root->node(a).type->find_event_in("place"), SFVec3f(1, 2, 3)));
  CHECK(inner_a->get<SFVec3f>(inner_a->roots()[0], "translation") == SFVec3f(1, 2, 3));
  CHECK(inner_b->get<SFVec3f>(inner_b->roots()[0], "translation") == SFVec3f(0));
}

TEST_CASE("uses an imported node between the children of a group, and prints its USE after the IMPORT") {
  const std::string text =
      "DEF T Transform { children DEF I Inline { } } IMPORT I.Mover AS M Transform { children USE M }";
  const auto scene = x3d_scene(text);
  CHECK_FALSE(find_imported(*scene, "M").scene);
  const auto inner = x3d_scene("DEF T Transform { } EXPORT T AS Mover");
  scene->inlines().attach(scene->get<MFNode>(scene->roots()[0], "children")[0], inner);
  CHECK(find_imported(*scene, "M").scene == inner);
  CHECK(find_imported(*scene, "M").node == inner->roots()[0]);
  CHECK_FALSE(find_imported(*scene, "N").scene);
  const std::string classic = printed_scene(*scene, {Grammar::x3d_classic});
  CHECK(classic.find("USE M") != std::string::npos);
  for (const Grammar grammar : {Grammar::x3d_classic, Grammar::x3d_xml, Grammar::x3d_json}) {
    const std::string printed = printed_scene(*scene, {grammar});
    CAPTURE(printed);
    SceneGraph again("again");
    read_again(printed, grammar, again);
    CHECK(printed_scene(again, {Grammar::x3d_classic}) == classic);
  }
  CHECK(printed_scene(*scene, {Grammar::x3d_xml}).find("<Group USE='M'/>") != std::string::npos);
  CHECK(printed_scene(*scene, {Grammar::vrml97}).find("USE M") == std::string::npos);
  SceneGraph wrong("wrong");
  Diagnostics diagnostics;
  (void)parse("#X3D V3.3 utf8\nDEF I Inline { } IMPORT I.B AS M Shape { geometry USE M }", wrong, diagnostics);
  CHECK(diagnostics.errors() == 1);
}

TEST_CASE("prints IMPORT in the body of a PROTO, with its ROUTEs") {
  const std::string text =
      "PROTO P [] { DEF T Transform { } DEF I Inline { } IMPORT I.Mover AS M ROUTE T.translation_changed TO "
      "M.set_translation } P { }";
  const auto scene = x3d_scene(text);
  const std::string classic = printed_scene(*scene, {Grammar::x3d_classic});
  for (const Grammar grammar : {Grammar::x3d_classic, Grammar::x3d_xml, Grammar::x3d_json}) {
    const std::string printed = printed_scene(*scene, {grammar});
    CAPTURE(printed);
    SceneGraph again("again");
    read_again(printed, grammar, again);
    CHECK(printed_scene(again, {Grammar::x3d_classic}) == classic);
    REQUIRE(again.inlines().instance_routes().size() == 1);
    CHECK(again.inlines().instance_routes()[0].to.name == "Mover");
  }
}
