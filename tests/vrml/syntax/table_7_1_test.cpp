#include "vrml/mesh/mesh.h"
#include "vrml/syntax/parser.h"

#include "tests/vrml/events/trace.h"

#include <catch2/catch.hpp>

#include <string>

// Tests of the minimum support of a browser (VRML97 7.3.3, Table 7-1). Each size is slightly exceeded. The limits in
// Limits are far higher.

namespace gs::vrml::traces {

namespace {

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

}  // namespace

TEST_CASE("accepts 500 children, in the file and by addChildren (Table 7-1)") {
  World world("DEF G Group { children [ " + repeated("Group { } ", 600) + "] } DEF H Group { }");
  CHECK(world.scene().get<MFNode>(world.node("G"), "children").size() == 600);
  world.start();
  world.send("H.addChildren", world.scene().get<MFNode>(world.node("G"), "children"));
  CHECK(world.scene().get<MFNode>(world.node("H"), "children").size() == 600);
}

TEST_CASE("accepts 1,000 keys, and 15,000 coordinates in a keyValue (Table 7-1)") {
  std::string keys, values;
  for (int i = 0; i <= 1000; ++i) {
    keys += std::to_string(i) + ' ';
    values += std::to_string(2 * i) + ' ';
  }
  World world("DEF I ScalarInterpolator { key [ " + keys + "] keyValue [ " + values +
              "] } DEF C CoordinateInterpolator { key [ 0 1 ] keyValue [ " + repeated("1 2 3, ", 8000) +
              repeated("3 4 5, ", 8000) + "] }");
  world.start();
  world.send("I.set_fraction", SFFloat{999.5F});
  CHECK(world.take() == Lines{"0 I.value_changed 1999"});
  world.send("C.set_fraction", SFFloat{0.5F});
  const Lines lines = world.take();
  REQUIRE(lines.size() == 1);
  CHECK(lines[0].size() > 8000 * 5);
  CHECK(lines[0].find("2 3 4, 2 3 4") != std::string::npos);
}

TEST_CASE("accepts 30 interfaces of each kind in a PROTO, 10 URLs, names of 50 octets (Table 7-1)") {
  const std::string tail(48, 'n');
  std::string interface;
  for (int i = 10; i < 45; ++i) {
    const std::string name = std::to_string(i) + tail;
    interface += " field SFInt32 f" + name + ' ' + std::to_string(i) + " eventIn SFInt32 i" + name +
                 " eventOut SFInt32 o" + name + " exposedField SFInt32 e" + name + " 1";
  }
  World world("PROTO P" + tail + " [" + interface + " ] { DEF S Switch { whichChoice IS e44" + tail + " } } DEF I P" +
              tail + " { f10" + tail + " 7 } Inline { url [ " + repeated("\"a.wrl\" ", 12) + "] }");
  CHECK(world.scene().get<SFInt32>(world.node("I"), "f10" + tail) == 7);
  CHECK(world.scene().get<SFInt32>(world.node("I"), "f44" + tail) == 44);
  CHECK(world.scene().get<MFString>(world.scene().roots()[1], "url").size() == 12);
  world.start();
  world.send("I.e44" + tail, SFInt32{3});
  CHECK(world.take("S.") == Lines{"0 S.whichChoice 3"});
}

TEST_CASE("accepts strings of 30,000 octets, lists of 15,000 strings, images of 256 x 256 pixels (Table 7-1)") {
  World world("WorldInfo { title \"" + std::string(32'000, 'x') + "\" info [ " + repeated("\"y\" ", 15'000) +
              "] } Shape { appearance Appearance { texture DEF T PixelTexture { image 256 256 4 " +
              repeated("0x01020304 ", 256 * 256) + "} } }");
  CHECK(world.scene().get<SFString>(world.scene().roots()[0], "title").view().size() == 32'000);
  CHECK(world.scene().get<MFString>(world.scene().roots()[0], "info").size() == 15'000);
  CHECK(world.scene().get<SFImage>(world.node("T"), "image").pixels().size() == 256 * 256);
}

TEST_CASE("draws 5,000 faces of 10 corners, 15,000 lines, 5,000 points, grids of 16,000 heights (Table 7-1)") {
  std::string points, faces;
  for (int i = 0; i < 5000; ++i) {
    for (int k = 0; k < 10; ++k)
      points += std::to_string(k < 5 ? k : 9 - k) + ' ' + std::to_string(k < 5 ? 0 : 1 + k % 2) + ' ' +
                std::to_string(i) + ", ";
    for (int k = 0; k < 10; ++k) faces += std::to_string(10 * i + k) + ' ';
    faces += "-1 ";
  }
  World world("Shape { geometry DEF F IndexedFaceSet { convex FALSE coord DEF C Coordinate { point [ " + points +
              "] } coordIndex [ " + faces + "] } } Shape { geometry DEF L IndexedLineSet { coord USE C coordIndex [ " +
              faces +
              "] } } Shape { geometry DEF P PointSet { coord USE C } } Shape { geometry DEF E ElevationGrid { "
              "xDimension 130 zDimension 130 height [ " +
              repeated("1 ", 130 * 130) + "] } }");
  CHECK(tessellate(world.scene(), world.node("F")).indices.size() == std::size_t{3} * 8 * 5000);
  CHECK(tessellate(world.scene(), world.node("L")).indices.size() == std::size_t{2} * 9 * 5000);
  CHECK(tessellate(world.scene(), world.node("P")).indices.size() == 50'000);
  CHECK(tessellate(world.scene(), world.node("E")).indices.size() == std::size_t{6} * 129 * 129);
}

}  // namespace gs::vrml::traces
