#include "app/insitu/bricks/pyramid.h"

#include <catch2/catch.hpp>

namespace gs::app::insitu {
namespace pyramid_test {

TEST_CASE("in situ pyramid: levels halve the grid down to the overview") {
  const Pyramid pyramid({129, 128, 200});
  REQUIRE(pyramid.levels() == 3);
  CHECK(pyramid.size(1) == GridIndex{65, 64, 100});
  CHECK(pyramid.size(2) == GridIndex{33, 32, 50});
  CHECK(pyramid.overview() == 2);
  CHECK(Pyramid({64, 64, 64}).levels() == 1);
  CHECK(Pyramid({1, 1, 1}).levels() == 1);
}

TEST_CASE("in situ pyramid: chunks cover a level, and only they belong to it") {
  const Pyramid pyramid({129, 128, 200});
  CHECK(pyramid.chunks(0).size() == 3 * 2 * 4);
  CHECK(pyramid.chunks(2).size() == 1);
  CHECK(pyramid.chunk_shape(2) == GridIndex{33, 32, 50});
  CHECK(pyramid.chunk_shape(0) == GridIndex{64, 64, 64});
  CHECK(pyramid.chunk_points(2) == 33 * 32 * 50);
  CHECK(pyramid.contains({0, {2, 1, 3}}));
  CHECK_FALSE(pyramid.contains({0, {3, 1, 3}}));
  CHECK_FALSE(pyramid.contains({0, {2, 2, 3}}));
  CHECK_FALSE(pyramid.contains({3, {0, 0, 0}}));
}

}  // namespace pyramid_test
}  // namespace gs::app::insitu
