#include "app/view/picture_detail.h"

#include <catch2/catch.hpp>

namespace gs::app::picture_detail_test {

TEST_CASE("draws late pictures more coarsely while the viewer moves, and finely at rest") {
  PictureDetail detail;
  CHECK(detail.coarseness(true) == 1);
  detail.note(1, false, 3);  // slow but complete, since there was no input
  CHECK(detail.coarseness(true) == 1);
  detail.note(1, true, 0.4);
  CHECK(detail.coarseness(true) == 2);
  CHECK(detail.coarseness(false) == 1);
  detail.note(1, true, 0.4);  // the fine picture, after too short a rest
  CHECK(detail.coarseness(true) == 2);
  detail.note(2, true, 0.4);
  CHECK(detail.coarseness(true) == 4);
  for (int i = 0; i < 5; ++i) detail.note(detail.coarseness(true), true, 0.4);
  CHECK(detail.coarseness(true) == PictureDetail::kMax);
}

TEST_CASE("refines pictures again as soon as finer ones are in time") {
  PictureDetail detail;
  detail.note(1, true, 0.4);
  detail.note(2, true, 0.4);
  detail.note(4, false, 0.3);
  CHECK(detail.coarseness(true) == 4);
  detail.note(4, false, 0.04);
  CHECK(detail.coarseness(true) == 2);
  detail.note(1, false, 0.01);  // at rest
  CHECK(detail.coarseness(true) == 2);
  detail.note(2, false, 0.04);
  CHECK(detail.coarseness(true) == 1);
  detail.note(1, false, 0.001);
  CHECK(detail.coarseness(true) == 1);
}

TEST_CASE("keeps the loading progress visible during slow pictures") {
  LoadingPace pace;
  CHECK(pace.go_on(10, 10.49));
  CHECK_FALSE(pace.go_on(10, 10.5));
  pace.note(true, 10, 10.6);
  CHECK_FALSE(pace.go_on(11, 11));  // the interface gets equal time
  pace.note(true, 11, 11);
  CHECK(pace.go_on(11.25, 12));
  CHECK_FALSE(pace.go_on(11.25, 12.25));
  for (double begin = 20; begin < 1000; begin += 50) pace.note(true, begin, begin + LoadingPace::kMax);
  CHECK(pace.go_on(2000, 2000 + LoadingPace::kMax - 0.1));
  CHECK_FALSE(pace.go_on(2000, 2000 + LoadingPace::kMax));
  pace.note(true, 2000, 2000.1);  // the next frame follows user input
  CHECK(pace.go_on(2001, 2003));
  pace.note(false, 2001, 2003);
  CHECK_FALSE(pace.go_on(2010, 2010.5));
}

}  // namespace gs::app::picture_detail_test
