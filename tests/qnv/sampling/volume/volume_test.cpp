#include "qnv/sampling/volume/volume_slices.h"

#include "tests/qnv/volume_sources.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

using namespace gs::qnv;
using gs::test::volume_of;

namespace {

template <class T>
std::vector<std::byte> stored(std::initializer_list<T> values, bool big_endian) {
  std::vector<std::byte> bytes;
  for (const T value : values) {
    std::array<std::byte, sizeof(T)> raw;
    std::memcpy(raw.data(), &value, sizeof(T));
    if (big_endian) std::reverse(raw.begin(), raw.end());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
  }
  return bytes;
}

template <class T>
void check_type(VoxelType type, std::initializer_list<T> values) {
  REQUIRE(size_of(type) == sizeof(T));
  for (const bool big_endian : {false, true}) {
    VolumeLayout layout;
    layout.type = type;
    layout.big_endian = big_endian;
    const std::vector<std::byte> bytes = stored(values, big_endian);
    std::vector<float> out(values.size());
    values_of(layout, bytes, out);
    std::size_t i = 0;
    for (const T value : values) CHECK(out[i++] == static_cast<float>(value));

    // Now the addresses are odd, and slope, intercept and missing values need the slower path.
    std::vector<std::byte> shifted(bytes.size() + 1);
    std::copy(bytes.begin(), bytes.end(), shifted.begin() + 1);
    layout.slope = 2;
    layout.intercept = -3;
    layout.missing = static_cast<double>(*values.begin());
    values_of(layout, std::span(shifted).subspan(1), out);
    CHECK(std::isnan(out[0]));
    for (i = 1; i < values.size(); ++i)
      CHECK(out[i] == static_cast<float>(static_cast<double>(values.begin()[i]) * 2 - 3));
  }
}

}  // namespace

TEST_CASE("converts voxels of every type and byte order to floats") {
  check_type<std::uint8_t>(VoxelType::u8, {0, 1, 127, 128, 255});
  check_type<std::int8_t>(VoxelType::i8, {0, 1, 127, -128, -1});
  check_type<std::uint16_t>(VoxelType::u16, {0, 1, 256, 0x1234, 65535});
  check_type<std::int16_t>(VoxelType::i16, {5, 1, 256, -32768, -2});
  check_type<std::uint32_t>(VoxelType::u32, {0, 1, 0x12345678, 4294967295u});
  check_type<std::int32_t>(VoxelType::i32, {7, 1, 0x12345678, -2147483647 - 1});
  check_type<float>(VoxelType::f32, {0.25f, -1.5f, 1e-30f, 3e30f});
  check_type<double>(VoxelType::f64, {0.25, -1.5, 1e-30, 1.0 / 3});
}

TEST_CASE("treats values that are not finite floats as missing") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  VolumeLayout layout;
  layout.type = VoxelType::f64;
  std::vector<float> out(6);
  values_of(layout, stored<double>({std::nan(""), infinity, -infinity, 1e300, -1e300, 1.0}, false), out);
  for (int i = 0; i < 5; ++i) CHECK(std::isnan(out[static_cast<std::size_t>(i)]));
  CHECK(out[5] == 1);

  SECTION("and so are bytes that are not there") {
    std::vector<float> more(4, 9.0f);
    values_of(layout, stored<double>({1.0, 2.0}, false), more);
    CHECK(more[1] == 2);
    CHECK(std::isnan(more[2]));
    CHECK(std::isnan(more[3]));
  }
  SECTION("and a slope that leads out of the floats") {
    layout.type = VoxelType::u8;
    layout.slope = 1e38;
    std::vector<float> two(2);
    values_of(layout, stored<std::uint8_t>({1, 200}, false), two);
    CHECK(two[0] == 1e38f);
    CHECK(std::isnan(two[1]));
    CHECK(may_miss(layout));
  }
}

TEST_CASE("rejects layouts that cannot be used") {
  VolumeLayout layout;
  layout.dimensions = {4, 5, 6};
  CHECK_FALSE(check(layout));
  const auto broken = [&](auto&& change) {
    VolumeLayout copy = layout;
    change(copy);
    const auto problem = check(copy);
    return problem && !problem->message.empty();
  };
  CHECK(broken([](VolumeLayout& l) { l.dimensions[1] = 0; }));
  CHECK(broken([](VolumeLayout& l) { l.dimensions = {0xffffffffu, 0xffffffffu, 0xffffffffu}; }));
  CHECK(broken([](VolumeLayout& l) { l.dimensions = {0xffffffffu, 0xffffffffu, 1}; }));
  CHECK(broken([](VolumeLayout& l) { l.axes[1] = l.axes[0]; }));
  CHECK(broken([](VolumeLayout& l) { l.axes[2] = glm::vec3(0); }));
  CHECK(broken([](VolumeLayout& l) { l.axes[2].y = std::nanf(""); }));
  CHECK(broken([](VolumeLayout& l) { l.origin.x = INFINITY; }));
  // These layouts have areas that are not finite.
  CHECK(broken([](VolumeLayout& l) { l.axes[1].y = -1.7e38f; }));
  CHECK(broken([](VolumeLayout& l) {
    for (glm::vec3& axis : l.axes) axis *= 1e-20f;
  }));
  CHECK(broken([](VolumeLayout& l) { l.origin.z = 3e38f; }));
  CHECK_FALSE(broken([](VolumeLayout& l) {
    for (glm::vec3& axis : l.axes) axis *= 1e-9f;
  }));
  CHECK(broken([](VolumeLayout& l) { l.slope = std::nan(""); }));
  CHECK(broken([](VolumeLayout& l) { l.type = static_cast<VoxelType>(200); }));
  CHECK_FALSE(broken([](VolumeLayout& l) { l.axes = gs::test::oblique(1, 1, 1).axes; }));
}

TEST_CASE("reads a slice, or reports it as missing") {
  VolumeLayout layout;
  layout.dimensions = {2, 2, 2};
  const VolumeSource source = volume_of<std::uint8_t>(layout, {1, 2, 3, 4, 5, 6, 7, 8});
  std::vector<std::byte> scratch;
  std::vector<float> values(4);
  REQUIRE(read_slice(source, 1, scratch, values));
  CHECK(values == std::vector<float>{5, 6, 7, 8});
  CHECK_FALSE(read_slice(source, 2, scratch, values));
  std::vector<float> few(3);
  CHECK_FALSE(read_slice(source, 0, scratch, few));
  const VolumeSource cut = volume_of<std::uint8_t>(layout, {1, 2, 3, 4, 5});
  CHECK_FALSE(read_slice(cut, 1, scratch, values));
}
