#include "tests/vrml/inventor/converted.h"

#include <algorithm>

// Sizes of converted scenes: equal nodes are shared, and groups without effect are left out.
namespace gs::vrml::inventor_sharing_test {

using test::Converted;
using test::kInventor;
using test::kVrml1;

namespace {

std::string printed(const std::string& text) { return print(Converted(text).scene); }

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

}  // namespace

TEST_CASE("shares equal shapes of a VRML 1.0 file") {
  const std::string text = printed(kVrml1 +
                                   "Separator { Cube { width 3 } Translation { translation 1 0 0 } Cube { width 3 } "
                                   "Translation { translation 1 0 0 } Cube { width 4 } }");
  CHECK(count(text, "Box {") == 2);
  CHECK(count(text, "Shape {") == 2);
  CHECK(count(text, "USE _Shape") == 1);
}

TEST_CASE("shares equal groups of a VRML 1.0 file, but not those with other names") {
  const std::string text = printed(kVrml1 +
                                   "Separator { "
                                   "Separator { Cube { width 3 } Sphere { radius 2 } } "
                                   "Separator { Cube { width 3 } Sphere { radius 2 } } "
                                   "DEF A Separator { Cube { width 3 } Sphere { radius 2 } } "
                                   "DEF B Separator { Cube { width 3 } Sphere { radius 2 } } }");
  CHECK(count(text, "Box {") == 1);
  CHECK(count(text, "DEF A Group {") == 1);
  CHECK(count(text, "DEF B Group {") == 1);
  CHECK(count(text, "Group {") == 4);
}

TEST_CASE("leaves out groups around one shape, but not around a light") {
  CHECK(count(printed(kVrml1 + "Separator { Separator { Separator { Cube { } } } }"), "Group {") == 0);
  CHECK(count(printed(kVrml1 + "Separator { Separator { PointLight { } } Cube { } }"), "Group {") >= 1);
  CHECK(count(printed(kVrml1 + "Separator { DEF Name Separator { Cube { } } }"), "DEF Name Group {") == 1);
}

TEST_CASE("does not share cameras and nodes with events") {
  const std::string cameras =
      printed(kInventor + "Separator { PerspectiveCamera { } } Separator { PerspectiveCamera { } }");
  CHECK(count(cameras, "Viewpoint {") == 2);
  const std::string moved = printed(kInventor + "Separator { Rotor { } Cube { } } Separator { Rotor { } Cube { } }");
  CHECK(count(moved, "TimeSensor {") == 2);
  CHECK(count(moved, "ROUTE ") >= 4);
}

TEST_CASE("converts an Array to rows that share their elements") {
  const Converted world(kInventor +
                        "Array { numElements1 10 numElements2 10 numElements3 10 separation2 0 2 0 origin CENTER "
                        "Cube { } }");
  const std::string text = print(world.scene);
  CHECK(count(text, "Transform {") <= 30);
  CHECK(count(text, "Shape {") == 1);
  CHECK(count(text, "translation -4.5 -9 -4.5") + count(text, "translation -4.5 -9 -3.5") >= 1);
}

TEST_CASE("shares equal nodes in time proportional to the scene") {
  std::string text = kVrml1 + "Separator { ";
  for (int i = 0; i < 20000; ++i)
    text += "Separator { Translation { translation " + std::to_string(i % 7) + " 0 0 } Cube { } } ";
  const Converted world(text + "}");
  CHECK(world.outcome == ParseOutcome::complete);
  CHECK(count(print(world.scene), "Transform {") == 6);
}

}  // namespace gs::vrml::inventor_sharing_test
