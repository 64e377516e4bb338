#include "tests/vrml/events/trace.h"

#include <string>

namespace gs::vrml::traces {

TEST_CASE("binds the first node of each bindable type at start (4.6.10)") {
  World world(
      "Group { children [ DEF V1 Viewpoint { } DEF V2 Viewpoint { } ] } DEF F Fog { } DEF B Background { } "
      "DEF N NavigationInfo { } Fog { }");
  world.start();
  CHECK(world.take() ==
        Lines{"0 V1.isBound TRUE", "0 V1.bindTime 1000", "0 F.isBound TRUE", "0 B.isBound TRUE", "0 N.isBound TRUE"});
  CHECK(world.execution().stacks().bound(*built_in_node_type("Viewpoint")).node == world.node("V1"));
}

TEST_CASE("binds only nodes in the active choice of a Switch at start (4.6.10, 6.46)") {
  World world(
      "Switch { whichChoice 1 choice [ DEF B1 Background { } Group { children DEF B2 Background { } } ] }\n"
      "Switch { choice DEF F1 Fog { } } Switch { whichChoice 5 choice DEF F2 Fog { } } DEF F3 Fog { }\n"
      "Switch { whichChoice 0 choice DEF V1 Viewpoint { } } DEF V2 Viewpoint { }");
  world.start();
  CHECK(world.take() == Lines{"0 B2.isBound TRUE", "0 F3.isBound TRUE", "0 V1.isBound TRUE", "0 V1.bindTime 1000"});
}

TEST_CASE("moves a node to the top on set_bind TRUE, and pops it on FALSE (4.6.10)") {
  World world("DEF A Viewpoint { } DEF B Viewpoint { } DEF C Viewpoint { }");
  world.start();
  (void)world.take();
  world.send_at(1, "B.set_bind", true);
  CHECK(world.take() == Lines{"1 A.isBound FALSE", "1 A.bindTime 1001", "1 B.isBound TRUE", "1 B.bindTime 1001"});
  world.send_at(2, "B.set_bind", true);  // already at the top
  world.send("C.set_bind", false);       // not on the stack
  CHECK(world.take().empty());
  world.send("C.set_bind", true);
  CHECK(world.take("isBound") == Lines{"2 B.isBound FALSE", "2 C.isBound TRUE"});
  world.send_at(3, "A.set_bind", false);  // below the top: sends no event
  CHECK(world.take().empty());
  world.send("C.set_bind", false);
  CHECK(world.take("isBound") == Lines{"3 C.isBound FALSE", "3 B.isBound TRUE"});
  world.send_at(4, "B.set_bind", false);
  CHECK(world.take("isBound") == Lines{"4 B.isBound FALSE"});
  CHECK(!world.execution().stacks().bound(*built_in_node_type("Viewpoint")).scene);
  world.send_at(5, "A.set_bind", true);
  CHECK(world.take("isBound") == Lines{"5 A.isBound TRUE"});
}

TEST_CASE("moves a node that is already on the stack to the top, without a second entry (4.6.10)") {
  World world("DEF A Background { } DEF B Background { } DEF C Background { }");
  world.start();
  world.send_at(1, "B.set_bind", true);
  world.send_at(2, "C.set_bind", true);
  world.send_at(3, "A.set_bind", true);
  (void)world.take();
  world.send_at(4, "A.set_bind", false);
  CHECK(world.take() == Lines{"4 A.isBound FALSE", "4 C.isBound TRUE"});
  world.send_at(5, "C.set_bind", false);
  world.send_at(6, "B.set_bind", false);
  CHECK(world.take() == Lines{"5 C.isBound FALSE", "5 B.isBound TRUE", "6 B.isBound FALSE"});
}

TEST_CASE("keeps a stack per bindable type, and binds nodes of an Inline only on set_bind (4.6.10)") {
  World world("DEF Part Inline { } DEF F Fog { }");
  auto content = std::make_unique<SceneGraph>("part.wrl", world.scene().budget());
  Diagnostics diagnostics;
  (void)parse("#VRML V2.0 utf8\nDEF V Viewpoint { } DEF G Fog { }", *content, diagnostics);
  SceneGraph& part = *content;
  world.scene().inlines().attach(world.node("Part"), std::move(content));
  world.execution().scenes().attach();
  world.start();
  CHECK(world.take() == Lines{"0 F.isBound TRUE"});
  const NodeId fog = part.roots()[1];
  world.step(1);
  CHECK(world.execution().send(part, fog, *part.node(fog).type->find("set_bind"), FieldValue(true)));
  CHECK(world.take() == Lines{"1 F.isBound FALSE", "1 G.isBound TRUE"});
}

TEST_CASE("sends isBound along ROUTEs, also from a PROTO instance") {
  World world(
      "PROTO P [ eventIn SFBool go eventOut SFBool there ] { Viewpoint { set_bind IS go isBound IS there } } "
      "Viewpoint { } DEF I P { } DEF L DirectionalLight { on FALSE } ROUTE I.there TO L.on");
  world.start();
  (void)world.take();
  world.send_at(1, "I.go", true);
  CHECK(world.take("L.") == Lines{"1 L.on TRUE"});
}

}  // namespace gs::vrml::traces
