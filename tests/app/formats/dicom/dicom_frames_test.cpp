#include "tests/app/formats/dicom/dicom_builder.h"

#include <cmath>

using namespace gs;
using namespace gs::test;

namespace {

/// Image module of 2 x 2 pixels of 8 bits.
DicomBuilder small_image(const char* modality, const char* color, int frames, int samples = 1) {
  DicomBuilder builder;
  builder.text(0x00080060, "CS", modality).text(0x0020000e, "UI", "1.2.9").text(0x00200011, "IS", "7");
  builder.number(0x00280002, static_cast<std::uint16_t>(samples)).text(0x00280004, "CS", color);
  if (samples > 1) builder.number(0x00280006, 0);
  builder.text(0x00280008, "IS", std::to_string(frames)).number(0x00280010, 2).number(0x00280011, 2);
  builder.number(0x00280100, 8).number(0x00280101, 8).number(0x00280102, 7).number(0x00280103, 0);
  return builder;
}

Bytes counted(int count, int from = 0) {
  Bytes pixels;
  for (int i = 0; i < count; ++i) put(pixels, static_cast<std::uint8_t>(from + i));
  return pixels;
}

DicomBuilder group_of(double z, int segment = 0, int time = 0) {
  DicomBuilder position, group;
  position.text(0x00200032, "DS", "1\\2\\" + std::to_string(z));
  group.sequence(0x00209113, {position});
  if (time > 0) {
    DicomBuilder content;
    Bytes index;
    put(index, static_cast<std::uint32_t>(time));
    content.bytes(0x00209128, "UL", index);
    group.sequence(0x00209111, {content});
  }
  if (segment > 0) {
    DicomBuilder number;
    number.number(0x0062000b, static_cast<std::uint16_t>(segment));
    group.sequence(0x0062000a, {number});
  }
  return group;
}

DicomBuilder shared_groups() {
  DicomBuilder orientation, measures, shared;
  orientation.text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
  measures.text(0x00180050, "DS", "3").text(0x00280030, "DS", "0.5\\0.75");
  shared.sequence(0x00209116, {orientation}).sequence(0x00289110, {measures});
  return shared;
}

std::vector<float> first_values(const qnv::VolumeSource& source) {
  std::vector<float> firsts;
  const std::vector<float> values = values_of(source);
  const std::size_t slice = std::size_t{source.layout.dimensions[0]} * source.layout.dimensions[1];
  for (std::size_t i = 0; i < values.size(); i += slice) firsts.push_back(values[i]);
  return firsts;
}

}  // namespace

TEST_CASE("places frames of a DICOM file by their functional groups") {
  ScratchFolder folder;
  DicomBuilder builder = small_image("MR", "MONOCHROME2", 3);
  builder.sequence(0x52009229, {shared_groups()});
  builder.sequence(0x52009230, {group_of(6), group_of(0), group_of(3)});
  builder.bytes(0x7fe00010, "OB", counted(12));
  const auto source = opened(folder.write("enhanced", builder.file()));
  CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{2, 2, 3});
  CHECK(source.layout.axes[0].x == 0.75f);
  CHECK(source.layout.axes[1].y == 0.5f);
  CHECK(source.layout.axes[2].z == 3);
  CHECK(first_values(source) == std::vector<float>{4, 8, 0});
}

TEST_CASE("reads frames of a DICOM file with numbers of times as steps") {
  ScratchFolder folder;
  DicomBuilder builder = small_image("MR", "MONOCHROME2", 4);
  builder.sequence(0x52009229, {shared_groups()});
  builder.sequence(0x52009230, {group_of(0, 0, 2), group_of(0, 0, 1), group_of(3, 0, 1), group_of(3, 0, 2)});
  builder.bytes(0x7fe00010, "OB", counted(16));
  const auto source = opened(folder.write("times", builder.file()));
  REQUIRE(source.steps.size() == 2);
  CHECK(first_values(source.steps[0]) == std::vector<float>{4, 8});
  CHECK(first_values(source.steps[1]) == std::vector<float>{0, 12});
}

TEST_CASE("reads a DICOM segmentation of bits as labels") {
  ScratchFolder folder;
  DicomBuilder builder;
  builder.text(0x00080060, "CS", "SEG").number(0x00280002, 1).text(0x00280004, "CS", "MONOCHROME2");
  builder.text(0x00280008, "IS", "3").number(0x00280010, 3).number(0x00280011, 3);
  builder.number(0x00280100, 1).number(0x00280101, 1).number(0x00280102, 0).number(0x00280103, 0);
  builder.text(0x00620001, "CS", "BINARY");
  builder.sequence(0x52009229, {shared_groups()});
  builder.sequence(0x52009230, {group_of(0, 1), group_of(0, 4), group_of(6, 4)});
  // 27 bits: pixel 0 of frame 0, pixel 1 of frame 1, pixel 8 of frame 2.
  builder.bytes(0x7fe00010, "OB", {std::byte{1}, std::byte{4}, std::byte{0}, std::byte{4}});
  const auto source = opened(folder.write("segments", builder.file()));
  CHECK(source.layout.labels);
  CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{3, 3, 3});  // slices are 3 mm apart
  const std::vector<float> values = values_of(source);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float expected = i == 0 ? 1.0f : i == 1 || i == 26 ? 4.0f : 0.0f;
    CHECK(values[i] == expected);
  }
}

TEST_CASE("places the frames of a DICOM dose by their offsets") {
  ScratchFolder folder;
  DicomBuilder builder = small_image("RTDOSE", "MONOCHROME2", 3);
  builder.text(0x00200032, "DS", "0\\0\\-7").text(0x00200037, "DS", "1\\0\\0\\0\\1\\0");
  builder.text(0x00280030, "DS", "2\\2").text(0x30040002, "CS", "GY").text(0x3004000c, "DS", "0\\5\\10");
  builder.text(0x3004000e, "DS", "0.5").bytes(0x7fe00010, "OB", counted(12));
  const auto source = opened(folder.write("dose", builder.file()));
  CHECK(source.layout.axes[2].z == 5);
  CHECK((source.layout.origin + source.layout.base).z == -7);
  CHECK(first_values(source) == std::vector<float>{0, 2, 4});
  CHECK(source.layout.metadata.size() > 2);
}

TEST_CASE("reads a DICOM movie as steps with its times") {
  ScratchFolder folder;
  DicomBuilder builder = small_image("XA", "MONOCHROME2", 3);
  builder.text(0x00181063, "DS", "40").bytes(0x7fe00010, "OB", counted(12));
  const auto source = opened(folder.write("movie", builder.file()));
  REQUIRE(source.steps.size() == 3);
  CHECK(source.times[2] == Approx(0.08));
  CHECK(values_of(source.steps[1])[0] == 4);
}

TEST_CASE("reads colours of DICOM files") {
  ScratchFolder folder;
  const Bytes pixels = counted(12, 100);
  SECTION("red, green and blue") {
    DicomBuilder builder = small_image("OT", "RGB", 1, 3);
    builder.bytes(0x7fe00010, "OB", pixels);
    const auto source = opened(folder.write("rgb", builder.file()));
    CHECK(source.layout.colors);
    REQUIRE(source.components.size() == 3);
    CHECK(values_of(source.components[0]) == std::vector<float>{100, 103, 106, 109});
    CHECK(values_of(source.components[2]) == std::vector<float>{102, 105, 108, 111});
    app::VoxelComponent green;
    green.index = 1;
    green.chosen = true;
    CHECK(values_of(opened_as(folder.path("rgb"), green)) == std::vector<float>{101, 104, 107, 110});
    green.magnitude = true;
    CHECK(values_of(opened_as(folder.path("rgb"), green))[0] == Approx(std::sqrt(100 * 100 + 101 * 101 + 102 * 102)));
  }
  SECTION("brightness and differences") {
    DicomBuilder builder = small_image("OT", "YBR_FULL", 1, 3);
    builder.bytes(0x7fe00010, "OB", bytes_of("\x50\x80\x80\x50\x80\xc0\x50\xc0\x80\x50\x80\x80"));
    const auto source = opened(folder.write("ybr", builder.file()));
    CHECK(values_of(source.components[0]) == std::vector<float>{80, 170, 80, 80});
    CHECK(values_of(source.components[2]) == std::vector<float>{80, 80, 193, 80});
  }
  SECTION("a palette") {
    DicomBuilder builder = small_image("US", "PALETTE COLOR", 1);
    Bytes descriptor, red, other;
    for (const int number : {4, 2, 16}) put(descriptor, static_cast<std::uint16_t>(number));
    for (int i = 0; i < 4; ++i) put(red, static_cast<std::uint16_t>(i * 0x1111)), put(other, std::uint16_t{0x4000});
    for (const std::uint32_t tag : {0x00281101u, 0x00281102u, 0x00281103u}) builder.bytes(tag, "US", descriptor);
    builder.bytes(0x00281201, "OW", red).bytes(0x00281202, "OW", other).bytes(0x00281203, "OW", other);
    builder.bytes(0x7fe00010, "OB", bytes_of(std::string("\1\3\4\x50", 4)));
    const auto source = opened(folder.write("palette", builder.file()));
    CHECK(values_of(source.components[0]) == std::vector<float>{0, 0x11, 0x22, 0x33});
    CHECK(values_of(source.components[1]) == std::vector<float>{0x40, 0x40, 0x40, 0x40});
  }
}

TEST_CASE("removes bits of DICOM pixels that are not stored") {
  ScratchFolder folder;
  DicomBuilder bits;
  bits.text(0x00080060, "CS", "MR").number(0x00280002, 1).text(0x00280004, "CS", "MONOCHROME2").number(0x00280010, 2);
  bits.number(0x00280011, 2).number(0x00280100, 16).number(0x00280101, 10).number(0x00280102, 11).number(0x00280103, 1);
  Bytes pixels;
  for (const int value : {0xf004, 0x0ffc, 0x0803, 0x07fc}) put(pixels, static_cast<std::uint16_t>(value));
  bits.bytes(0x7fe00010, "OW", pixels);
  CHECK(values_of(opened(folder.write("bits", bits.file()))) == std::vector<float>{1, -1, -512, 511});
}

TEST_CASE("reads damaged DICOM frames without harm") {
  ScratchFolder folder;
  DicomBuilder builder = small_image("MR", "MONOCHROME2", 2);
  builder.sequence(0x52009229, {shared_groups()});
  builder.sequence(0x52009230, {group_of(6, 1, 1), group_of(0, 2, 1)});
  builder.bytes(0x7fe00010, "OB", counted(8));
  check_late_damage(folder, "changed", bytes_of(builder.file()));
}
