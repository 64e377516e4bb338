#include "app/session/documents/splat_edits.h"

#include "app/formats/export/export.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/interface/driver.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <future>
#include <string>
#include <variant>
#include <vector>

namespace gs::app::splat_edits_test {
namespace {

using driver::Driver;

/// User with an open file of 300 splats.
struct SplatUser {
  explicit SplatUser(const qnv::Gaussians& splats = test::random_gaussians(300, 1)) : user({}, {1100, 800}) {
    const auto made = export_splats_ply(splats);
    const auto& bytes = std::get<std::vector<std::byte>>(made);
    path = folder.write("scene.ply", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    user.session().opening().open_files({path});
    REQUIRE(user.wait_for([&] { return user.session().view() && count() == 300; }));
  }
  [[nodiscard]] Document& document() { return *user.session().view()->document; }
  [[nodiscard]] SplatEdits& edits() { return document().splats; }
  /// Returns the number of splats in the picture.
  [[nodiscard]] std::size_t count() {
    const auto& splats = user.session().view()->list->splats;
    return splats.size() == 1 && splats[0].geometry ? splats[0].geometry->size() : 0;
  }
  bool shows(std::size_t number) {
    return user.wait_for([&] { return count() == number && !edits().busy(); });
  }
  [[nodiscard]] bool edited() { return user.controller().title().find(", edited") != std::string::npos; }

  ScratchFolder folder;
  std::string path;
  Driver user;
};

SplatEdit crop_of(double size) {
  SplatEdit edit;
  edit.crops = {{SplatBox{glm::dvec3(-size), glm::dvec3(size)}}};
  return edit;
}

/// Returns the number of splats that an edit leaves.
std::size_t left_by(const SplatEdit& edit) {
  qnv::Gaussians splats = test::random_gaussians(300, 1);
  (void)edit_splats(splats, edit);
  return splats.size();
}

}  // namespace

TEST_CASE("shows edited splats in the picture, and undoes and redoes each gesture") {
  SplatUser it;
  REQUIRE(only_splats(it.document().world));
  const SplatEdit small = crop_of(0.5), large = crop_of(1);
  REQUIRE(left_by(small) < left_by(large));
  it.edits().set(large, 1001, 1);
  REQUIRE(it.shows(left_by(large)));
  it.edits().set(small, 1002, 1);  // the same gesture
  REQUIRE(it.shows(left_by(small)));
  CHECK(it.edits().removed().cropped == 300 - left_by(small));
  CHECK(it.edited());
  SplatEdit moved = small;
  moved.move = {5, 0, 0};
  it.edits().set(moved, 1003, 2);
  REQUIRE(it.user.wait_for([&] { return it.user.session().view()->list->bounds.lower.x > 4; }));
  it.user.press(letter_key('Z'), true);
  CHECK(it.edits().edit() == small);
  it.user.press(letter_key('Z'), true);
  CHECK(it.edits().edit().empty());
  REQUIRE(it.shows(300));
  CHECK_FALSE(it.edited());
  it.user.press(letter_key('Z'), true, true);
  REQUIRE(it.shows(left_by(small)));
}

TEST_CASE("shows an empty picture if an edit removes all splats, and all of them after a reset") {
  SplatUser it;
  SplatEdit none;
  none.most_size = 1e-9;
  it.edits().set(none, 1001, 1);
  REQUIRE(it.shows(0));
  it.edits().set({}, 1002, 2);
  REQUIRE(it.shows(300));
}

TEST_CASE("takes edited splats in the first step after the thread that makes them wakes the program") {
  SplatUser it;
  std::promise<void> woken, done;
  it.edits().set(crop_of(0.5), 1001, 1);
  CHECK_FALSE(it.edits().follow(it.document(), [&] {
    woken.set_value();
    done.get_future().wait_for(std::chrono::milliseconds(50));  // the future is not ready yet
  }));
  woken.get_future().wait();
  CHECK(it.edits().follow(it.document(), nullptr));
  CHECK_FALSE(it.edits().busy());
}

TEST_CASE("knows the extent of the splats before the edit") {
  SplatUser it;
  const SplatExtent before = it.edits().extent(it.document().world);
  CHECK(before.whole.lower.x <= before.middle.lower.x);
  CHECK(before.middle.upper.y <= before.whole.upper.y);
  CHECK(before.largest > 0.9f);
  it.edits().set(crop_of(0.5), 1001, 1);
  REQUIRE(it.shows(left_by(crop_of(0.5))));
  CHECK(it.edits().extent(it.document().world).whole.upper == before.whole.upper);
}

TEST_CASE("puts the first crop box around a scene, and leaves floaters outside") {
  qnv::Gaussians splats = test::random_gaussians(300, 1);
  splats.positions[7] = {500, 0, 0};
  SplatUser it(splats);
  const SplatExtent extent = it.edits().extent(it.document().world);
  CHECK(extent.whole.upper.x == Approx(500));
  CHECK(extent.middle.upper.x < 50);
  SplatEdit edit;
  edit.crops = {{SplatBox{extent.middle.lower, extent.middle.upper}}};
  (void)edit_splats(splats, edit);
  CHECK(splats.size() < 300);
  CHECK(splats.size() > 290);  // the positions are normally distributed
}

TEST_CASE("edits only files of splats") {
  Driver user({}, {1100, 800});
  user.show_world("Shape { geometry Box { } }");
  CHECK_FALSE(only_splats(user.session().view()->document->world));
  user.press(letter_key('G'), true, true);
  CHECK(user.sees("This panel edits"));
}

TEST_CASE("the Splats panel crops, resets and asks before edits are lost") {
  SplatUser it;
  it.user.press(letter_key('G'), true, true);
  INFO(it.user.screen());
  CHECK(it.user.sees("300 of 300 splats"));
  it.user.click("Add box");
  REQUIRE(it.edits().edit().crops.size() == 1);
  const std::size_t left = left_by(it.edits().edit());
  CHECK(left < 300);
  REQUIRE(it.shows(left));
  it.user.settle();
  CHECK(it.user.sees(std::to_string(left) + " of 300 splats"));
  CHECK(it.user.sees("From"));
  it.user.click("Remove");
  REQUIRE(it.shows(300 - left));
  it.user.click("Add sphere");
  REQUIRE(it.edits().edit().crops.size() == 2);
  it.user.settle();
  CHECK(it.user.sees("Radius"));
  REQUIRE(it.shows(left_by(it.edits().edit())));
  it.user.click("Delete");
  REQUIRE(it.edits().edit().crops.size() == 1);
  CHECK(it.shows(left_by(it.edits().edit())));
  CHECK_FALSE(it.user.controller().may_close());
  it.user.settle();
  REQUIRE(it.user.sees("has changes that are not saved"));
  it.user.press(Key::escape);
  it.user.click("Reset all");
  CHECK(it.edits().edit().empty());
  REQUIRE(it.shows(300));
}

TEST_CASE("edits a stream of splats, of which views show only parts") {
  const auto made = qnv::encode_gaussians(test::random_gaussians(300, 1), {});
  const auto& bytes = std::get<qnv::EncodedStream>(made).bytes;
  const ScratchFolder folder;
  const std::string path =
      folder.write("scene.qnv", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  Driver user({}, {800, 600});
  user.session().opening().open_files({path});
  const auto gaussians = [&]() -> const qnv::Gaussians* {
    const View* const view = user.session().view();
    if (!view || view->list->splats.size() != 1 || !view->list->splats[0].geometry) return nullptr;
    return view->list->splats[0].geometry->as<qnv::Gaussians>();
  };
  REQUIRE(user.wait_for([&] { return gaussians() && gaussians()->stream; }));
  Document& document = *user.session().view()->document;
  CHECK(document.splats.extent(document.world).largest > 0);
  document.splats.set(crop_of(0.5), 1001);
  REQUIRE(user.wait_for([&] { return gaussians() && !gaussians()->stream && !document.splats.busy(); }));
  CHECK(gaussians()->size() > 0);
  CHECK(gaussians()->size() < 150);
  CHECK(gaussians()->size() + document.splats.removed().cropped == 300);
  document.splats.go(-1);
  REQUIRE(user.wait_for([&] { return gaussians() && gaussians()->stream; }));
}

}  // namespace gs::app::splat_edits_test
