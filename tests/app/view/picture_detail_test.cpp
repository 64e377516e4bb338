#include "app/view/picture_detail.h"

#include <catch2/catch.hpp>

namespace gs::app::picture_detail_test {

TEST_CASE("Pictures that are given up are drawn more coarsely while the viewer moves, and finely when he stands") {
  PictureDetail detail;
  CHECK(detail.coarseness(true) == 1);
  detail.note(1, false, 3);  // slow, but whole: nobody did anything
  CHECK(detail.coarseness(true) == 1);
  detail.note(1, true, 0.4);
  CHECK(detail.coarseness(true) == 2);
  CHECK(detail.coarseness(false) == 1);
  detail.note(1, true, 0.4);  // the fine one, for which he stood too shortly
  CHECK(detail.coarseness(true) == 2);
  detail.note(2, true, 0.4);
  CHECK(detail.coarseness(true) == 4);
  for (int i = 0; i < 5; ++i) detail.note(detail.coarseness(true), true, 0.4);
  CHECK(detail.coarseness(true) == PictureDetail::kMost);
}

TEST_CASE("Pictures become finer again as soon as finer ones would not be late") {
  PictureDetail detail;
  detail.note(1, true, 0.4);
  detail.note(2, true, 0.4);
  detail.note(4, false, 0.3);
  CHECK(detail.coarseness(true) == 4);
  detail.note(4, false, 0.04);
  CHECK(detail.coarseness(true) == 2);
  detail.note(1, false, 0.01);  // of one who stands
  CHECK(detail.coarseness(true) == 2);
  detail.note(2, false, 0.04);
  CHECK(detail.coarseness(true) == 1);
  detail.note(1, false, 0.001);
  CHECK(detail.coarseness(true) == 1);
}

}  // namespace gs::app::picture_detail_test
