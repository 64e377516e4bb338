#include "tests/app/script/scripts.h"

// Tests of the field objects of ISO/IEC 19777-1.
namespace gs::app::x3d_fields_test {

using scripts::Lines;
using scripts::run_x3d;
using scripts::x3d_value;
using scripts::X3DWorld;

TEST_CASE("makes colours and vectors of the X3D types with components and indexes") {
  CHECK(x3d_value("c.r + ' ' + c.g + ' ' + c.b + ' ' + c.a + ' ' + c[3]",
                  "var c = new SFColorRGBA(0.5, 0.25, 1, 0.75);") == "0.5 0.25 1 0.75 0.75");
  CHECK(x3d_value("c", "var c = new SFColorRGBA(); c.a = 0.5;") == "0 0 0 0.5");
  CHECK(x3d_value("new SFVec2d(0.1, 2).add(new SFVec2d(1, 1))") == "1.1 3");
  CHECK(x3d_value("new SFVec3d(1, 2, 3).cross(new SFVec3d(0, 0, 1))") == "2 -1 0");
  CHECK(x3d_value("new SFVec3d(0.1, 0, 0)") == "0.1 0 0");
  CHECK(x3d_value("v.w + ' ' + v.length() + ' ' + v.dot(v)", "var v = new SFVec4f(1, 1, 1, 1);") == "1 2 4");
  CHECK(x3d_value("new SFVec4d(1, 2, 3, 4).multiply(2).subtract(new SFVec4d(1, 1, 1, 1))") == "1 3 5 7");
  CHECK(x3d_value("new SFVec3f(0, 0, 0).lerp(new SFVec3f(2, 4, 6), 0.5)") == "1 2 3");
  CHECK(x3d_value("new SFVec3f(0, 3, 0).distance(new SFVec3f(4, 0, 0))") == "5");
}

TEST_CASE("makes lists of the X3D types with length, indexes and the methods of arrays") {
  CHECK(x3d_value("l.length + ' ' + l[1] + ' ' + l", "var l = new MFBool(true, false);") == "2 false [ TRUE, FALSE ]");
  CHECK(x3d_value("l", "var l = new MFDouble(0.1, 2); l[2] = 3;") == "[ 0.1, 2, 3 ]");
  CHECK(x3d_value("l[0].a + ' ' + l.length", "var l = new MFColorRGBA(new SFColorRGBA(1, 1, 1, 0.5));") == "0.5 1");
  CHECK(x3d_value("l", "var l = new MFVec3d(); l[0] = new SFVec3d(0.1, 2, 3); l[0].y = 5;") == "[ 0.1 5 3 ]");
  CHECK(x3d_value("l.length + ' ' + l[2]", "var l = new MFVec4f(); l[2].w = 1;") == "3 0 0 0 1");
  CHECK(x3d_value("l.map(v => v.x).join()", "var l = new MFVec2d(new SFVec2d(1, 2), new SFVec2d(3, 4));") == "1,3");
  CHECK(
      x3d_value("l[0] + '; ' + l[1]", "var l = new MFMatrix3f(); l[1] = new SFMatrix3f(2, 0, 0, 0, 2, 0, 0, 0, 2);") ==
      "1 0 0 0 1 0 0 0 1; 2 0 0 0 2 0 0 0 2");
  CHECK(x3d_value("l[0].width + ' ' + l.length", "var l = new MFImage(new SFImage(2, 1, 1, new MFInt32(5, 6)));") ==
        "2 1");
  CHECK(x3d_value("i.width + ' ' + i.height", "var i = new SFImage(2, 1, 1, new MFInt32(5, 6));") == "2 1");
}

TEST_CASE("transforms points by matrices of four rows") {
  const std::string move = "var m = new SFMatrix4f(); m.setTransform(new SFVec3f(1, 2, 3));";
  CHECK(x3d_value("m", move) == "1 0 0 0 0 1 0 0 0 0 1 0 1 2 3 1");
  CHECK(x3d_value("m.multVecMatrix(new SFVec3f(1, 1, 1))", move) == "2 3 4");
  CHECK(x3d_value("m.multVecMatrix(new SFVec4f(1, 1, 1, 0))", move) == "1 1 1 0");
  CHECK(x3d_value("m.inverse()[3][0] + ' ' + m.transpose()[0][3] + ' ' + m.multLeft(m)[3][2]", move) == "-1 1 6");
  CHECK(x3d_value("t + ' ' + s", move + "var t = new SFVec3f(), r = new SFRotation(), s = new SFVec3f();"
                                        "m.getTransform(t, r, s);") == "1 2 3 1 1 1");
  CHECK(x3d_value("m[0][0]", "var m = new SFMatrix4d(0.1);") == "0.1");
  CHECK(x3d_value("new X3DMatrix4() instanceof SFMatrix4f") == "true");
}

TEST_CASE("transforms points of the plane by matrices of three rows") {
  const std::string move =
      "var m = new X3DMatrix3(); m.setTransform(new SFVec2f(1, 2), Math.PI / 2, new SFVec2f(2, 2));";
  CHECK(x3d_value("p.x.toFixed(3) + ' ' + p.y.toFixed(3)", move + "var p = m.multVecMatrix(new SFVec2f(1, 0));") ==
        "1.000 4.000");
  CHECK(x3d_value("[t, r.z.toFixed(4), s.x.toFixed(3)].join()",
                  move + "var t = new SFVec2f(), r = new SFVec3f(), s = new SFVec2f(); m.getTransform(t, r, s);") ==
        "1 2,1.5708,2.000");
  CHECK(x3d_value("m.multiply === undefined ? m.inverse().multLeft(m)[0][0].toFixed(3) : 0", move) == "1.000");
  CHECK(x3d_value("new SFMatrix3d(new SFVec3f(1, 2, 3), new SFVec3f(4, 5, 6), new SFVec3f(7, 8, 9))") ==
        "1 2 3 4 5 6 7 8 9");
}

TEST_CASE("reads and writes the fields of an X3D Script, and parts of their values") {
  CHECK(run_x3d("print(d + ' ' + v.z + ' ' + m[1][1] + ' ' + b[1] + ' ' + c.a);",
                "initializeOnly SFDouble d 0.1 initializeOnly SFVec3d v 1 2 3 inputOutput SFMatrix3f m "
                "1 0 0 0 5 0 0 0 1 initializeOnly MFBool b [ TRUE FALSE ] initializeOnly SFColorRGBA c 1 1 1 0.5") ==
        Lines{"0.1 3 5 false 0.5"});
  CHECK(run_x3d("m[2][0] = 7; v.x = 9; l[1].w = 4; print(m + '; ' + v + '; ' + l);",
                "initializeOnly SFMatrix3f m 1 0 0 0 1 0 0 0 1 initializeOnly SFVec4d v 1 2 3 4 "
                "initializeOnly MFVec4f l [ 0 0 0 0, 1 1 1 1 ]") ==
        Lines{"1 0 0 0 1 0 7 0 1; 9 2 3 4; [ 0 0 0 0, 1 1 1 4 ]"});
}

TEST_CASE("keeps the API of VRML97 in worlds of VRML97") {
  using scripts::value;
  for (const char* const name : {"SFVec4f", "X3DConstants", "MFBool", "X3DScene", "SFMatrix3f"}) {
    INFO(name);
    CHECK(value(std::string("typeof ") + name) == "undefined");
  }
  CHECK(value("typeof Browser.currentScene") == "undefined");
  CHECK(value("new SFNode('Group { }').getNodeType()") == "Group");
}

}  // namespace gs::app::x3d_fields_test
