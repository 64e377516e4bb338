// Compares pictures of the interface with small pinned ones beside this file. These are means of blocks of eight
// pixels, They tolerate other letter shapes, but not other positions, colours or content. GHOSTSPACE_KEEP_PICTURES=1
// writes them again; check them before a commit.
#include "app/formats/common/color_key.h"
#include "app/view/values/color_bar.h"
#include "render/image/image_codecs.h"
#include "tests/app/interface/driver.h"
#include "tests/app/interface/interface_picture.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

namespace gs::app::interface_pictures_test {

using driver::Driver;
using render::Image;

constexpr glm::ivec2 kWindow{720, 480};
constexpr std::uint32_t kBlock = 8;
constexpr int kMaxDifference = 24;      // of 255, of the mean of a block
constexpr double kMaxOfPicture = 0.02;  // share of blocks that may differ: a caret, another font

const char* const kBody =
    "Viewpoint { description \"Front\" } DEF Lamp PointLight { } "
    "DEF Things Group { children [ DEF Ball Shape { geometry Sphere { radius 2 } } Shape { geometry Box {} } ] }";

// Returns nullopt if there is no such picture.
std::optional<Image> kept(const std::string& name) {
  std::ifstream file(std::string(GHOSTSPACE_TESTS) + "/app/interface/pictures/" + name + ".png", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  auto decoded = render::decode_png(std::as_bytes(std::span(bytes)), {});
  if (auto* image = std::get_if<Image>(&decoded)) return std::move(*image);
  return std::nullopt;
}

void write(const std::string& path, const Image& image) {
  const auto bytes = render::encode_png(image);
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void check_picture(const std::string& name) {
  const Image whole = driver::picture_of_interface(), now = driver::means_of_blocks(whole, kBlock);
  if (std::getenv("GHOSTSPACE_KEEP_PICTURES")) {
    write(std::string(GHOSTSPACE_TESTS) + "/app/interface/pictures/" + name + ".png", now);
    write("/tmp/" + name + ".png", whole);
  }
  const auto before = kept(name);
  REQUIRE(before);
  INFO(name);
  CHECK(driver::share_that_differs(*before, now, kMaxDifference) <= kMaxOfPicture);
}

// Opens the scene tree on the left and the inspector on the right, for a ball.
void open_panels(Driver& user) {
  user.show_world(kBody);
  user.press(letter_key('T'), true, true);
  user.press(letter_key('I'), true, true);
  user.click("Things");
  user.settle();
}

TEST_CASE("draws a window with panels as pinned") {
  Driver user({}, kWindow);
  open_panels(user);
  check_picture("panels");
}

TEST_CASE("draws a menu with a submenu as pinned") {
  Driver user({}, {960, 480});
  user.show_world(kBody);
  user.click("View");
  user.click("Faces");
  check_picture("menus");
}

TEST_CASE("draws two viewports and the command palette as pinned") {
  Driver user({}, kWindow);
  user.show_world(kBody);
  user.press(Key::right, true, true);
  user.press(letter_key('P'), true, true);
  user.type("view");
  check_picture("palette");
}

TEST_CASE("keeps the numbers of a colour bar readable in both themes") {
  Driver user({}, kWindow);
  user.show_world(kBody);
  user.set_model([](UiModel& model) {
    model.tools.color_bar = true;
    model.tools.bar = color_bar_of(ColorKey{"heat (K)", 0, 100, viridis_colors()});
  });
  for (int theme = 0; theme < 2; ++theme) {
    INFO(theme);
    user.settle();
    const auto title = user.find("heat");
    REQUIRE(title);
    const Image picture = driver::picture_of_interface();
    int brightest = 0, darkest = 255;
    for (int y = -8; y <= 8; ++y)
      for (int x = -16; x <= 16; ++x) {
        const auto row = static_cast<std::size_t>(title->y + static_cast<float>(y)),
                   column = static_cast<std::size_t>(title->x + static_cast<float>(x));
        const int red = picture.pixels[3 * (row * picture.width + column)];
        brightest = std::max(brightest, red);
        darkest = std::min(darkest, red);
      }
    CHECK(brightest > 160);
    CHECK(darkest < 60);
    user.click("View");
    user.click("Switch dark and light theme");
  }
}

TEST_CASE("draws equal windows after equal input, and shows a change") {
  Image first;
  {
    Driver user({}, kWindow);
    open_panels(user);
    first = driver::picture_of_interface();
  }
  Driver user({}, kWindow);
  open_panels(user);
  CHECK(driver::picture_of_interface().pixels == first.pixels);
  const Image before = driver::means_of_blocks(first, kBlock);
  const auto difference = [&] {
    return driver::share_that_differs(before, driver::means_of_blocks(driver::picture_of_interface(), kBlock),
                                      kMaxDifference);
  };
  // A missing panel, or other colours, exceed the tolerance.
  user.press(letter_key('I'), true, true);
  CHECK(difference() > kMaxOfPicture);
  user.press(letter_key('I'), true, true);
  user.click("View");
  user.click("Switch dark and light theme");
  user.settle();
  CHECK(difference() > kMaxOfPicture);
}

}  // namespace gs::app::interface_pictures_test
