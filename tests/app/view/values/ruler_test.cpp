#include "app/view/values/ruler.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

namespace gs::app::ruler_test {

TEST_CASE("measures distances of two points, angles and areas of three, and lengths of more") {
  Ruler ruler;
  CHECK(ruler.length() == 0);
  CHECK(ruler.add({0, 0, 0}));
  CHECK(ruler.distance() == 0);
  CHECK(ruler.add({3, 0, 4}));
  CHECK(ruler.distance() == 5);
  CHECK(ruler.summary("mm") == "5 mm");
  CHECK_FALSE(ruler.area());
  CHECK(ruler.add({3, 12, 4}));
  CHECK(ruler.length() == 17);
  CHECK(ruler.distance() == 13);
  CHECK(*ruler.angle_at(1) == Approx(90));
  CHECK(*ruler.area() == Approx(30));  // half of 5 times 12
  CHECK(ruler.summary() == "length 17, angle 90 degrees, area 30");
  CHECK_FALSE(ruler.angle_at(0));
  CHECK_FALSE(ruler.angle_at(2));
  CHECK(ruler.text("mm") ==
        "point 1: 0, 0, 0\npoint 2: 3, 0, 4\npoint 3: 3, 12, 4\nfrom 1 to 2: 5 mm\nfrom 2 to 3: 12 mm\n"
        "angle at 2: 90 degrees\nlength: 17 mm\ndistance: 13 mm\narea: 30 mm^2\n");
  CHECK(ruler.undo());
  CHECK(ruler.points().size() == 2);
}

TEST_CASE("measures the area of a concave or distant polygon by its outline") {
  Ruler ruler;
  // An L of three unit squares, a thousand kilometres from the origin.
  for (const auto& [x, y] : {std::pair{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}})
    CHECK(ruler.add({1e6 + x, y, -1e6}));
  CHECK(*ruler.area() == Approx(3));
  CHECK(ruler.length() == Approx(6));  // without the closing edge
}

TEST_CASE("measures small angles exactly, and rejects invalid points") {
  Ruler ruler;
  CHECK(ruler.add({1, 0, 0}));
  CHECK(ruler.add({0, 0, 0}));
  CHECK(ruler.add({1, 1e-9, 0}));
  CHECK(*ruler.angle_at(1) == Approx(1e-9 * 180 / 3.14159265358979).epsilon(1e-6));
  CHECK_FALSE(ruler.add({std::nan(""), 0, 0}));
  CHECK_FALSE(ruler.add({0, std::numeric_limits<double>::infinity(), 0}));
  CHECK(ruler.points().size() == 3);
  ruler.clear();
  CHECK(ruler.add({0, 0, 0}));
  CHECK(ruler.add({0, 0, 0}));
  CHECK(ruler.add({0, 0, 1}));
  CHECK_FALSE(ruler.angle_at(1));
  CHECK(*ruler.area() == 0);
  for (std::size_t i = 3; i < Ruler::kMaxPoints; ++i) CHECK(ruler.add({0, 0, 0}));
  CHECK_FALSE(ruler.add({0, 0, 0}));
}

}  // namespace gs::app::ruler_test
