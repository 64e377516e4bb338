#include "app/picture/volume_show.h"

#include "app/loading/world_loader.h"
#include "app/session/viewports/view.h"
#include "tests/app/scratch_folder.h"

#include <catch2/catch.hpp>

#include <memory>
#include <string>

namespace gs::app::volume_show_test {
namespace {

/// Returns a NRRD file with these sizes. Its values rise from 0 along the first axis; the last value is 255.
std::string nrrd(int x, int y, int z) {
  std::string text = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: " + std::to_string(x) + " " + std::to_string(y) +
                     " " + std::to_string(z) + "\nencoding: raw\n\n";
  for (int i = 0; i < x * y * z; ++i) text += static_cast<char>(i % x);
  text.back() = static_cast<char>(255);
  return text;
}

View view_of_file(const std::string& path) { return view_of(make_document(load_world(path)), {64, 64}, {}); }

TEST_CASE("recognises a volume of one layer as an image") {
  const ScratchFolder folder;
  const auto axis_of = [&](int x, int y, int z) {
    const View view = view_of_file(folder.write("a.nrrd", nrrd(x, y, z)));
    const qnv::Description* const volume = first_volume(*view.list);
    REQUIRE(volume);
    return image_axis(*volume);
  };
  CHECK(axis_of(20, 10, 1) == 2u);
  CHECK(axis_of(20, 1, 10) == 1u);
  CHECK(axis_of(20, 10, 2) == std::nullopt);
  CHECK(axis_of(20, 1, 1) == std::nullopt);
}

TEST_CASE("shows an image as one slice, with colours for all values but outliers") {
  const ScratchFolder folder;
  const auto grid = VolumeGrid::read(folder.write("a.nrrd", nrrd(40, 30, 1)));
  REQUIRE(std::holds_alternative<std::shared_ptr<const VolumeGrid>>(grid));
  VolumeSlices slices;
  slices.map = "viridis";
  slices.shown = {true, true, false};
  show_image(*std::get<0>(grid), 2, slices);
  CHECK(slices.shown == std::array{false, false, true});
  CHECK(slices.alone);
  CHECK(slices.map == "viridis");
  REQUIRE(slices.window);
  CHECK(slices.window->first == 0);
  CHECK(slices.window->second == 39);

  slices.window = {5.0f, 6.0f};
  show_image(*std::get<0>(grid), 2, slices);
  CHECK(slices.window == std::pair{5.0f, 6.0f});
}

TEST_CASE("draws an image as a plane in pictures, unless options choose slices") {
  const ScratchFolder folder;
  const std::string path = folder.write("a.nrrd", nrrd(40, 30, 1));
  const View view = view_of_file(path);
  const auto planes = [&](const VolumeWishes& wishes, const std::string& file) {
    VolumeShow show;
    CHECK(show.prepare(wishes, file, *view.list, std::nullopt, own_budget()) == std::nullopt);
    PictureScene scene;
    scene.list = view.list.get();
    show.apply(scene);
    std::size_t count = 0;
    for (const render::DrawItem& item : scene.list->items) count += item.texture.image ? 1 : 0;
    return std::pair{count, scene.list->splats.size()};
  };
  CHECK(planes({}, path) == std::pair{std::size_t{1}, std::size_t{0}});
  CHECK(planes({}, folder.path("a.qnv")) == std::pair{std::size_t{0}, std::size_t{1}});  // a stream has no values
  VolumeWishes both;
  both.slices = {*read_slice_wish("z=0"), *read_slice_wish("x=50%")};
  CHECK(planes(both, path) == std::pair{std::size_t{2}, std::size_t{1}});
}

}  // namespace
}  // namespace gs::app::volume_show_test
