#include "app/view/panes/picture_ledger.h"

#include <catch2/catch.hpp>

#include <memory>

namespace gs::app::picture_ledger_test {

render::FrameStatistics drawn(bool pending = false, std::size_t vectors = 0) {
  render::FrameStatistics statistics;
  statistics.pending = pending;
  statistics.vectors = vectors;
  return statistics;
}

PictureSource source_of(const std::shared_ptr<const render::RenderList>& list) {
  PictureSource source;
  source.list = list;
  source.shown = list.get();
  source.changes = list->changes;
  source.draw.width = source.draw.height = 100;
  return source;
}

TEST_CASE("keeps a picture while none of its parts changes") {
  const auto list = std::make_shared<const render::RenderList>(), other = std::make_shared<const render::RenderList>();
  PictureLedger ledger;
  const PictureSource source = source_of(list);
  CHECK_FALSE(ledger.is_same(0, source));
  CHECK_FALSE(ledger.stands(0, false));
  ledger.note(0, source, drawn(), 0.01);
  CHECK(ledger.is_same(0, source));
  CHECK(ledger.stands(0, false));
  CHECK_FALSE(ledger.is_same(1, source));  // the picture is of another viewport
  CHECK_FALSE(ledger.wants_more(0));

  const auto changed = [&](auto change) {
    PictureSource now = source;
    change(now);
    return !ledger.is_same(0, now);
  };
  CHECK(changed([&](PictureSource& now) { now.list = other; }));
  CHECK(changed([&](PictureSource& now) { now.shown = other.get(); }));  // the view shows slices
  CHECK(changed([](PictureSource& now) { now.changes = 5; }));           // the world has advanced
  CHECK(changed([](PictureSource& now) { now.grown = 1; }));             // a stream has grown, or a movie has advanced
  CHECK(changed([](PictureSource& now) { now.camera.world_from_camera[3].x = 1; }));
  CHECK(changed([](PictureSource& now) { now.camera.field_of_view = 1; }));
  CHECK(changed([](PictureSource& now) { now.draw.width = 101; }));
  CHECK(changed([](PictureSource& now) { now.draw.budget = 7; }));
  CHECK(changed([](PictureSource& now) { now.draw.headlight = false; }));
  CHECK(changed([](PictureSource& now) { now.draw.background = glm::vec3(1); }));
  CHECK(changed([](PictureSource& now) { now.draw.splat_style.opacity = 3; }));
  CHECK(changed([](PictureSource& now) { now.draw.splat_style.color_by = render::ColorBy::normal; }));
  CHECK(changed([](PictureSource& now) { now.draw.splat_style.transfer.resize(2); }));
  CHECK(changed([](PictureSource& now) { now.draw.splats = render::SplatPath::gl; }));
  CHECK_FALSE(changed([](PictureSource& now) { now.draw.go_on = [] { return false; }; }));
}

TEST_CASE("detects a new list at the address of a removed one") {
  PictureLedger ledger;
  auto list = std::make_shared<const render::RenderList>();
  ledger.note(0, source_of(list), drawn(), 0);
  PictureSource same_place = source_of(list);
  const auto successor = std::make_shared<const render::RenderList>();
  same_place.list = successor;  // everything else is equal, also the address of the list
  list.reset();
  CHECK_FALSE(ledger.is_same(0, same_place));
}

TEST_CASE("redraws a picture that can improve, unless that delays the user") {
  const auto list = std::make_shared<const render::RenderList>();
  const PictureSource source = source_of(list);
  PictureLedger ledger;
  ledger.note(0, source, drawn(true, 100), 2 * PictureLedger::kQuick);
  CHECK(ledger.wants_more(0));
  CHECK_FALSE(ledger.stands(0, false));
  CHECK(ledger.stands(0, true));
  ledger.note(0, source, drawn(true, 200), PictureLedger::kQuick / 2);
  CHECK_FALSE(ledger.stands(0, true));
  // Refinement ends if every picture still reports that a better one will follow.
  for (int i = 0; i <= Refinement::kMaxFramesAlike; ++i) ledger.note(0, source, drawn(true, 200), 0);
  CHECK_FALSE(ledger.wants_more(0));
  CHECK(ledger.stands(0, false));
  PictureSource moved = source;
  moved.camera.field_of_view = 1;
  ledger.note(0, moved, drawn(true, 200), 0);
  CHECK(ledger.wants_more(0));
}

TEST_CASE("ignores an abandoned picture") {
  const auto list = std::make_shared<const render::RenderList>();
  const PictureSource source = source_of(list);
  PictureLedger ledger;
  ledger.note(0, source, drawn(), 0);
  ledger.note_given_up(0, drawn());
  CHECK_FALSE(ledger.is_same(0, source));
  CHECK_FALSE(ledger.wants_more(0));  // the caller reports when there is another picture
}

}  // namespace gs::app::picture_ledger_test
