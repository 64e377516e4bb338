#include "tests/vrml/events/trace.h"

#include "vrml/scene/values/transformation.h"

// Tests of the interfaces that X3D adds to ProximitySensor (X3D 22.4.1).
namespace gs::vrml::traces {

TEST_CASE("sends centerOfRotation_changed in the sensor's coordinates while the viewer is inside (X3D 22.4.1)") {
  X3DWorld world("Transform { translation 1 0 0 children DEF P ProximitySensor { size 10 10 10 } }");
  world.execution().viewer().set(viewer_matrix({1, 0, 3}, {}));
  world.execution().viewer().set_center({1, 2, 0});
  world.start();
  CHECK(world.take("centerOfRotation") == Lines{"0 P.centerOfRotation_changed 0 2 0"});
  CHECK(world.take_at(1).empty());
  world.execution().viewer().set_center({5, 2, 0});
  CHECK(world.take_at(2) == Lines{"2 P.centerOfRotation_changed 4 2 0"});
  world.execution().viewer().set(viewer_matrix({50, 0, 3}, {}));
  (void)world.take_at(3);
  world.execution().viewer().set_center({6, 2, 0});
  CHECK(world.take_at(4).empty());
}

}  // namespace gs::vrml::traces
