#include "app/session/documents/world_edits.h"

#include <catch2/catch.hpp>

namespace gs::app::world_edits_test {
namespace {

const vrml::InterfaceDeclaration kRadius, kHeight;

WorldEdit edit(float before, float after, double time = 0, std::uint64_t gesture = 0,
               const vrml::InterfaceDeclaration& field = kRadius) {
  return {nullptr, {1, 1}, &field, &field, before, after, time, gesture};
}

}  // namespace

TEST_CASE("undoes and redoes edits, newest first") {
  WorldEdits edits;
  edits.note(edit(1, 2, 10));
  edits.note(edit(2, 3, 11));
  CHECK(edits.time_of(-1) == 11);
  CHECK_FALSE(edits.time_of(1));
  CHECK(std::get<float>(edits.go(-1)->before) == 2);
  CHECK(std::get<float>(edits.go(-1)->before) == 1);
  CHECK_FALSE(edits.go(-1));
  CHECK(std::get<float>(edits.go(1)->after) == 2);
  edits.note(edit(2, 7, 12));
  CHECK_FALSE(edits.time_of(1));  // a new edit ends the redoing
}

TEST_CASE("counts the edits of one field during a gesture as one") {
  WorldEdits edits;
  edits.note(edit(1, 2, 0, 5));
  edits.note(edit(2, 3, 0, 5));
  edits.note(edit(1, 9, 0, 5, kHeight));
  edits.note(edit(9, 8, 0, 6, kHeight));
  CHECK(std::get<float>(edits.go(-1)->before) == 9);
  CHECK(std::get<float>(edits.go(-1)->before) == 1);
  CHECK(std::get<float>(edits.go(-1)->before) == 1);
  CHECK_FALSE(edits.go(-1));
}

TEST_CASE("reports unsaved edits, even after an undo beyond the saved state") {
  WorldEdits edits;
  CHECK_FALSE(edits.unsaved());
  edits.note(edit(1, 2, 0, 5));
  CHECK(edits.unsaved());
  edits.mark_saved();
  CHECK_FALSE(edits.unsaved());
  edits.note(edit(2, 3, 0, 5));  // the same gesture, but the first part is saved
  CHECK(edits.unsaved());
  (void)edits.go(-1);
  CHECK_FALSE(edits.unsaved());
  (void)edits.go(-1);
  CHECK(edits.unsaved());
  edits.note(edit(1, 4));
  CHECK(edits.unsaved());
  (void)edits.go(-1);
  CHECK(edits.unsaved());
}

TEST_CASE("returns the last value of each field, even of edits that cannot be undone any more") {
  WorldEdits edits;
  edits.note(edit(1, 2, 0, 0, kHeight));
  for (std::size_t i = 0; i < WorldEdits::kMaxUndone + 10; ++i)
    edits.note(edit(static_cast<float>(i), static_cast<float>(i + 1)));
  const std::vector<WorldEdit> latest = edits.latest();
  REQUIRE(latest.size() == 2);
  CHECK(std::get<float>(latest[0].after) == 2);
  CHECK(std::get<float>(latest[1].after) == static_cast<float>(WorldEdits::kMaxUndone + 10));
}

}  // namespace gs::app::world_edits_test
