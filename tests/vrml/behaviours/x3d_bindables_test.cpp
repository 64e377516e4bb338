#include "tests/vrml/events/trace.h"

// Tests of the interfaces that X3D adds to bindable nodes (X3D 23.3.1, 24.3.1).
namespace gs::vrml::traces {

TEST_CASE("binds the NavigationInfo of a Viewpoint together with it (X3D 23.3.1)") {
  X3DWorld world(
      "DEF N NavigationInfo { } DEF A Viewpoint { } DEF B Viewpoint { navigationInfo DEF M NavigationInfo { } }");
  world.start();
  (void)world.take();
  world.send_at(1, "B.set_bind", SFBool{true});
  CHECK(world.take("isBound") ==
        Lines{"1 A.isBound FALSE", "1 B.isBound TRUE", "1 N.isBound FALSE", "1 M.isBound TRUE"});
  world.send_at(2, "B.set_bind", SFBool{false});
  CHECK(world.take("isBound") ==
        Lines{"2 B.isBound FALSE", "2 A.isBound TRUE", "2 M.isBound FALSE", "2 N.isBound TRUE"});
}

TEST_CASE("sends bindTime from all bindable nodes of X3D, in one stack for each kind (X3D 24.3.1)") {
  X3DWorld world("DEF V Viewpoint { } DEF O OrthoViewpoint { } DEF F Fog { } DEF B Background { }");
  world.start();
  CHECK(world.take("bindTime").size() == 3);
  world.send_at(1, "O.set_bind", SFBool{true});
  CHECK(world.take("isBound") == Lines{"1 V.isBound FALSE", "1 O.isBound TRUE"});
  CHECK(world.execution().viewer().pose()[3].z == 10);
  CHECK(world.execution().viewer().frustum().up > 0);
}

}  // namespace gs::vrml::traces
