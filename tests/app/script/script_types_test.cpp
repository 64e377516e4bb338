#include "scripts.h"

namespace gs::app::script_types_test {

using scripts::Lines;
using scripts::run;
using scripts::value;
using scripts::World;

TEST_CASE("SFColor has r, g, b, indexes and HSV (C.6.4)") {
  CHECK(value("c.r + ' ' + c.g + ' ' + c.b + ' ' + c[0] + ' ' + c[1] + ' ' + c[2]",
              "var c = new SFColor(0.5, 0.25, 1);") == "0.5 0.25 1 0.5 0.25 1");
  CHECK(value("new SFColor(0.5)") == "0.5 0 0");  // missing values are 0.0
  CHECK(value("c", "var c = new SFColor(); c.g = 0.5; c[2] = 0.25;") == "0 0.5 0.25");
  CHECK(value("new SFColor(0, 1, 0).getHSV()[0] * 3") == "1");
  CHECK(value("new SFColor(0, 0.5, 0).getHSV()[2]") == "0.5");
  CHECK(value("c", "var c = new SFColor(1, 1, 1); c.setHSV(0.5, 1, 0.5);") == "0 0.5 0.5");
  CHECK(value("new SFColor(0.1, 0.2, 0.3).toString()") == "0.1 0.2 0.3");
}

TEST_CASE("SFImage has x, y, comp and array (C.6.5)") {
  CHECK(value("i.x + ' ' + i.y + ' ' + i.comp + ' ' + i.array.length + ' ' + i.array[1]",
              "var i = new SFImage(1, 2, 3, new MFInt32(255, 0xff00));") == "1 2 3 2 65280");
  CHECK(value("i", "var i = new SFImage(1, 2, 1, new MFInt32(7, 8));") == "1 2 1 7 8");
  CHECK(run("image.array[1] = 9; print(image.array[1]);", "field SFImage image 1 2 1 5 6") == Lines{"9"});
}

TEST_CASE("makes an SFRotation of numbers, of axis and angle, and of two vectors (C.6.7.2)") {
  CHECK(value("new SFRotation(1, 0, 0, 0.5)") == "1 0 0 0.5");
  CHECK(value("new SFRotation()") == "0 1 0 0");  // "missing values default to 0.0, except y"
  CHECK(value("new SFRotation(new SFVec3f(0, 0, 1), 0.25)") == "0 0 1 0.25");
  CHECK(value("r.x + ' ' + r.y + ' ' + r.z + ' ' + (r.angle - Math.PI / 2)",
              "var r = new SFRotation(new SFVec3f(1, 0, 0), new SFVec3f(0, 1, 0));") == "0 0 1 0");
  CHECK(value("Math.abs(r.multVec(new SFVec3f(1, 0, 0)).x + 1) < 1e-9",
              "var r = new SFRotation(new SFVec3f(1, 0, 0), new SFVec3f(-1, 0, 0));") == "true");
}

TEST_CASE("rotates, multiplies, inverts and interpolates by SFRotation (C.6.7.4)") {
  const std::string quarter =
      "var r = new SFRotation(0, 0, 1, Math.PI / 2), s = new SFRotation(1, 0, 0, Math.PI / 2);"
      "function round(v) { return [Math.round(v.x), Math.round(v.y), Math.round(v.z)]; }";
  CHECK(value("r.getAxis()", quarter) == "0 0 1");
  CHECK(value("round(r.multVec(new SFVec3f(1, 0, 0)))", quarter) == "0,1,0");
  CHECK(value("round(r.inverse().multVec(new SFVec3f(0, 1, 0)))", quarter) == "1,0,0");
  // Vectors are rows (C.6.19), so r applies first, from x to y. Then s applies, from y to z.
  CHECK(value("round(r.multiply(s).multVec(new SFVec3f(1, 0, 0)))", quarter) == "0,0,1");
  CHECK(value("r", quarter + "r.setAxis(new SFVec3f(0, 1, 0)); r.angle = 0.5;") == "0 1 0 0.5");
  CHECK(value("r.slerp(new SFRotation(0, 0, 1, 0), 0)", "var r = new SFRotation(0, 0, 1, 1);") == "0 0 1 1");
  CHECK(value("r.slerp(new SFRotation(1, 0, 0, 0.5), 1)", "var r = new SFRotation(0, 0, 1, 1);") == "1 0 0 0.5");
  CHECK(value("Math.round(1000 * r.slerp(new SFRotation(0, 0, 1, 1), 0.25).angle)",
              "var r = new SFRotation(0, 0, 1, 0);") == "250");
}

TEST_CASE("adds, subtracts and scales SFVec2f and SFVec3f, and returns their length (C.6.8, C.6.9)") {
  const std::string two = "var a = new SFVec2f(3, 4), b = new SFVec2f(1, 2);";
  CHECK(value("a.add(b) + ', ' + a.subtract(b) + ', ' + a.multiply(2) + ', ' + a.divide(2)", two) ==
        "4 6, 2 2, 6 8, 1.5 2");
  CHECK(value("a.dot(b) + ' ' + a.length() + ' ' + a.normalize() + ' ' + a[1] + ' ' + a.x", two) == "11 5 0.6 0.8 4 3");
  const std::string three = "var a = new SFVec3f(2, 3, 6), b = new SFVec3f(1, 0, 0);";
  CHECK(value("a.add(b) + ', ' + a.subtract(b) + ', ' + a.multiply(2) + ', ' + a.divide(2) + ', ' + a.negate()",
              three) == "3 3 6, 1 3 6, 4 6 12, 1 1.5 3, -2 -3 -6");
  CHECK(value("a.dot(b) + ' ' + a.length() + ' ' + a.cross(b) + ' ' + a[2] + ' ' + a.z", three) == "2 7 0 6 -3 6 6");
  CHECK(value("new SFVec3f(0, 0, 5).normalize() + ', ' + new SFVec3f()") == "0 0 1, 0 0 0");
}

TEST_CASE("extends MF objects by assignment, and sets their length (C.6.10 to C.6.18)") {
  const std::pair<const char*, const char*> lists[] = {
      {"var m = new MFInt32(1, 2, 3); m.length = 1; m[1] = 7.9;", "[ 1, 7 ]"},
      {"var m = new MFVec3f(); m[1] = new SFVec3f(1, 2, 3);", "[ 0 0 0, 1 2 3 ]"},
      {"var m = new MFVec2f(new SFVec2f(1, 2));", "[ 1 2 ]"},
      {"var m = new MFColor(); m[1] = new SFColor(1, 0, 0);", "[ 0 0 0, 1 0 0 ]"},
      {"var m = new MFRotation(); m.length = 1;", "[ 0 0 1 0 ]"},
      {"var m = new MFVec3f(); m[1].y = 2;", "[ 0 0 0, 0 2 0 ]"},
  };
  for (const auto& [program, list] : lists) CHECK(value("m", program) == list);
  CHECK(value("m.length + ' ' + m", "var m = new MFFloat(1, 2); m[3] = 5;") == "4 [ 1, 2, 0, 5 ]");
  CHECK(value("m.length + m[1]", "var m = new MFString('a', 'b');") == "2b");
  CHECK(value("m[1] + m[0]", "var m = new MFTime(0.25); m[1] = 1;") == "1.25");
  CHECK(value("m[0] == null && m[1] == n", "var n = new SFNode('Group {}'); var m = new MFNode(); m[1] = n;") ==
        "true");
}

TEST_CASE("copies an element of an MF object, and changes it in place (C.6.2)") {
  // The example of C.7.
  CHECK(run("eO = new SFVec3f(0, 1, 2); a = eO; b = a; a.x = 3; f[1] = a; c = f[1]; f[1].y = 4;"
            "print(eO); print(a); print(b); print(f[1]); print(c);",
            "eventOut SFVec3f eO field MFVec3f f []") == Lines{"0 1 2", "3 1 2", "3 1 2", "3 4 2", "3 1 2"});
  CHECK(run("var m = f; m[0] = 5; print(f[0]); f[0] = 7; print(m[0]);", "field MFInt32 f [ 1 ]") == Lines{"1", "5"});
  CHECK(run("v.x = 5; print(v); print(v.x);", "field SFVec3f v 1 2 3") == Lines{"5 2 3", "5"});
}

TEST_CASE("stores 4 x 4 numbers in a VrmlMatrix, with the translation in its fourth row (C.6.19)") {
  CHECK(value("new VrmlMatrix()") == "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1");
  const std::string made = "var m = new VrmlMatrix(1,2,3,4, 5,6,7,8, 9,10,11,12, 13,14,15,16);";
  CHECK(value("m[3][0] + ' ' + m[0][3]", made) == "13 4");
  CHECK(value("m[1][2]", made + "m[1][2] = 0.5;") == "0.5");
  CHECK(value("m.transpose()", made) == "1 5 9 13 2 6 10 14 3 7 11 15 4 8 12 16");
  const std::string moved =
      "var m = new VrmlMatrix(); m.setTransform(new SFVec3f(1, 2, 3)); var s = new VrmlMatrix();"
      "s.setTransform(new SFVec3f(0, 0, 0), new SFRotation(0, 0, 1, 0), new SFVec3f(2, 2, 2));";
  CHECK(value("m.multVecMatrix(new SFVec3f(1, 1, 1))", moved) == "2 3 4");
  CHECK(value("m.multMatrixVec(new SFVec3f(0, 0, 0))", moved) == "0 0 0");
  CHECK(value("m.inverse().multVecMatrix(new SFVec3f(1, 2, 3))", moved) == "0 0 0");
  // For row vectors, multRight appends the later transformation.
  CHECK(value("m.multRight(s).multVecMatrix(new SFVec3f(0, 0, 0))", moved) == "2 4 6");
  CHECK(value("m.multLeft(s).multVecMatrix(new SFVec3f(1, 0, 0))", moved) == "3 2 3");
  CHECK(value("t + ', ' + s",
              "var m = new VrmlMatrix(), t = new SFVec3f(), r = new SFRotation(), s = new SFVec3f();"
              "m.setTransform(new SFVec3f(1, 2, 3), new SFRotation(0, 0, 1, 0), new SFVec3f(2, 3, 4));"
              "m.getTransform(t, r, s);") == "1 2 3, 2 3 4");
  // The centre is unchanged (6.52).
  CHECK(value("v.x + v.y < 2.0001 && v.x > 0.9999",
              "var m = new VrmlMatrix(); m.setTransform(new SFVec3f(0, 0, 0), new SFRotation(0, 0, 1, 1),"
              "new SFVec3f(1, 1, 1), new SFRotation(0, 0, 1, 0), new SFVec3f(1, 1, 0));"
              "var v = m.multVecMatrix(new SFVec3f(1, 1, 0));") == "true");
}

TEST_CASE("converts numbers, booleans and strings to ECMAScript types, with TRUE, FALSE and NULL (C.6.2)") {
  CHECK(run("print(typeof b + ' ' + typeof i + ' ' + typeof f + ' ' + typeof t + ' ' + typeof s);"
            "print(b && TRUE); print(n == NULL); i = 2.9; print(i); s = 5; print(s + 1);",
            "field SFBool b TRUE field SFInt32 i 1 field SFFloat f 1 field SFTime t 1 field SFString s \"a\" "
            "field SFNode n NULL") == Lines{"boolean number number number string", "true", "true", "2", "51"});
}

}  // namespace gs::app::script_types_test
