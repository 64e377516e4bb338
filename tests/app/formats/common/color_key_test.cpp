#include "app/formats/common/color_key.h"
#include "tests/app/worlds.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace gs::app::color_key_test {

const std::vector<vrml::Color> kRainbow{{0, 0, 1}, {0, 1, 1}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0}};

TEST_CASE("converts a value to a colour, and a colour to a value") {
  for (const auto& colors : {kRainbow, viridis_colors()}) {
    const ColorKey key{"pressure (Pa)", -20, 80, colors};
    CHECK(key.color_of(-20) == colors.front());
    CHECK(key.color_of(80) == colors.back());
    CHECK(key.color_of(1e9) == colors.back());
    CHECK(key.color_of(std::nan("")) == vrml::Color{0.5f, 0.5f, 0.5f});
    for (double value = -20; value <= 80; value += 2.5)
      CHECK(key.value_of(key.color_of(value)) == Approx(value).margin(1e-4));
    CHECK(key.color_of(30) == colors[2]);
  }
  const ColorKey one{"", 5, 5, kRainbow};
  CHECK(one.color_of(5) == kRainbow[2]);
  CHECK(one.value_of({1, 0, 0}) == 5);
}

TEST_CASE("writes the meaning of colours to a WorldInfo, and reads it back") {
  const ColorKey key{"pressure (Pa)", -0.125, 101325, viridis_colors()};
  const std::string text = color_key_text(key);
  CHECK(text == "color key: -0.125 101325 #440154 #3b528b #21918c #5ec962 #fde725 pressure (Pa)");
  const auto back = read_color_key(text);
  REQUIRE(back);
  CHECK(back->title == key.title);
  CHECK(back->low == key.low);
  CHECK(back->high == key.high);
  CHECK(back->colors == key.colors);
  CHECK(read_color_key("color key: 0 1 #000000 #FFFFFF")->title.empty());

  for (const char* const bad :
       {"", "color", "color key:", "color key: 0 1", "color key: 0 1 #000000", "color key: 1 0 #000000 #ffffff",
        "color key: nan 1 #000000 #ffffff", "color key: 0 inf #000000 #ffffff", "color key: 0 1 #00000g #ffffff",
        "color key: 0 1 000000 ffffff", "Color key: 0 1 #000000 #ffffff"})
    CHECK_FALSE(read_color_key(bad));
  std::string many = "color key: 0 1";
  for (int i = 0; i < 64; ++i) many += " #123456";
  CHECK(read_color_key(many));
  CHECK_FALSE(read_color_key(many + " #123456"));
}

TEST_CASE("reads the meaning of colours from worlds of any program") {
  const LoadedWorld world = world_of(
      "PROTO P [ ] { WorldInfo { info \"color key: 9 9 #000000 #ffffff\" } } "
      "WorldInfo { title \"A wing\" info [ \"by nobody\", \"color key: 0 2 #0000ff #ff0000 Mach\" ] }");
  const auto key = color_key_of(*world.scene);
  REQUIRE(key);
  CHECK(key->title == "Mach");
  CHECK(key->high == 2);
  CHECK_FALSE(color_key_of(*world_of("Shape { geometry Box { } }").scene));
}

TEST_CASE("writes the meaning of colours to the metadata of a stream") {
  const ColorKey key{"pressure (Pa)", -0.125, 101325, viridis_colors()};
  const auto said = color_key_metadata(key);
  CHECK(said.first == "color key");
  CHECK(said.second == "-0.125 101325 #440154 #3b528b #21918c #5ec962 #fde725 pressure (Pa)");
  using Metadata = std::vector<std::pair<std::string, std::string>>;
  const auto back = color_key_of(Metadata{{"title", "x"}, {"color key", "nonsense"}, said});
  REQUIRE(back);
  CHECK(back->title == key.title);
  CHECK(back->high == key.high);
  CHECK(back->colors == key.colors);
  for (const char* wrong : {"", "1", "2 1 #000000 #ffffff", "0 1 #000000", "nan 1 #000000 #ffffff"})
    CHECK_FALSE(color_key_of(Metadata{{"color key", wrong}}));
}

}  // namespace gs::app::color_key_test
