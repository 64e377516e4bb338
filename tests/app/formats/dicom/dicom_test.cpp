#include "app/formats/dicom/dicom_datasets.h"
#include "app/formats/dicom/dicom_volume.h"
#include "tests/app/formats/dicom/dicom_builder.h"

#include <cmath>

using namespace gs;
using namespace gs::test;

namespace {

using DicomForms = DicomBuilder::Form;

/// Writes slices as files of a folder. Returns the path of the folder.
std::string scan_of(const ScratchFolder& folder, const std::vector<CtSlice>& slices) {
  for (std::size_t i = 0; i < slices.size(); ++i) folder.write("scan/I" + std::to_string(i), slices[i].file());
  return folder.path("scan");
}

CtSlice at_height(double z, int first) {
  CtSlice slice;
  slice.position = "-10\\20\\" + std::to_string(z);
  slice.first = first;
  slice.instance = first;
  return slice;
}

glm::vec3 axis(const qnv::VolumeSource& source, std::size_t i) { return source.layout.axes[i]; }

bool is_near(const glm::vec3& a, const glm::vec3& b) { return glm::distance(a, b) < 1e-4f; }

}  // namespace

TEST_CASE("sorts the slices of a DICOM folder by position") {
  ScratchFolder folder;
  folder.write("scan/notes.txt", "no image");
  folder.write("scan/inner/.hidden", "x");
  const auto source = opened(scan_of(folder, {at_height(6, 300), at_height(2, 100), at_height(4, 200)}));
  CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{4, 3, 3});
  CHECK(is_near(axis(source, 0), {0.25f, 0, 0}));  // the second number of the spacing is that of columns
  CHECK(is_near(axis(source, 1), {0, 0.5f, 0}));
  CHECK(is_near(axis(source, 2), {0, 0, 2}));
  CHECK(is_near(glm::vec3(source.layout.origin + source.layout.base), {-10, 20, 2}));
  const std::vector<float> values = values_of(source);
  CHECK(values[0] == 100 - 1024);
  CHECK(values[12] == 200 - 1024);
  CHECK(values[35] == 311 - 1024);
  CHECK(metadata_values(source.layout, "units") == std::vector<std::string>{"HU"});
  CHECK(source.layout.type == VoxelType::u16);
}

TEST_CASE("reads a tilted DICOM series with slices beside each other") {
  ScratchFolder folder;
  std::vector<CtSlice> slices;
  for (int i = 0; i < 3; ++i) {
    CtSlice slice = at_height(2 * i, 100);
    slice.position = "0\\" + std::to_string(i) + "\\" + std::to_string(2 * i);
    slice.instance = i + 1;
    slices.push_back(slice);
  }
  CHECK(is_near(axis(opened(scan_of(folder, slices)), 2), {0, 1, 2}));
}

TEST_CASE("reads an oblique DICOM series along its normal") {
  ScratchFolder folder;
  std::vector<CtSlice> slices;
  for (int i = 0; i < 3; ++i) {
    CtSlice slice = at_height(0, 100 * (3 - i));
    slice.orientation = "0\\1\\0\\0\\0\\-1";  // sagittal: the normal is -x
    slice.position = std::to_string(i) + "\\0\\0";
    slices.push_back(slice);
  }
  const auto source = opened(scan_of(folder, slices));
  CHECK(is_near(axis(source, 0), {0, 0.25f, 0}));
  CHECK(is_near(axis(source, 1), {0, 0, -0.5f}));
  CHECK(is_near(axis(source, 2), {-1, 0, 0}));
  CHECK(values_of(source)[0] == 100 - 1024);
}

TEST_CASE("leaves missing slices of a DICOM series empty and counts them") {
  ScratchFolder folder;
  const auto source =
      opened(scan_of(folder, {at_height(0, 100), at_height(2, 200), at_height(8, 300), at_height(10, 400)}));
  CHECK(source.layout.dimensions[2] == 6);
  const std::vector<float> values = values_of(source);
  CHECK(values[12] == 200 - 1024);
  CHECK(std::isnan(values[24]));
  CHECK(std::isnan(values[47]));
  CHECK(values[48] == 300 - 1024);
  CHECK(metadata_values(source.layout, "note") == std::vector<std::string>{"2 slices are missing"});
}

TEST_CASE("mixes slices of a DICOM series at unequal distances") {
  ScratchFolder folder;
  const auto source = opened(scan_of(folder, {at_height(0, 100), at_height(2, 200), at_height(5, 500)}));
  CHECK(source.layout.dimensions[2] == 4);
  CHECK(axis(source, 2).z == Approx(5.0 / 3));
  const std::vector<float> values = values_of(source);
  CHECK(values[12] == Approx(100 + 100 * 5.0 / 6 - 1024));
  CHECK(values[24] == Approx(200 + 300 * 4.0 / 9 - 1024));
  REQUIRE(metadata_values(source.layout, "note").size() == 1);
  CHECK(metadata_values(source.layout, "note")[0] == "slices are 2 mm to 3 mm apart; mixed to slices of 1.667 mm");
}

TEST_CASE("scales slices of a DICOM series by their own slopes") {
  ScratchFolder folder;
  CtSlice second = at_height(1, 200);
  second.slope = "2";
  const auto source = opened(scan_of(folder, {at_height(0, 100), second}));
  CHECK(source.layout.type == VoxelType::f32);
  CHECK(values_of(source)[0] == 100 - 1024);
  CHECK(values_of(source)[12] == 400 - 1024);
}

TEST_CASE("reads several images at each place of a DICOM series as steps") {
  ScratchFolder folder;
  std::vector<CtSlice> slices;
  for (int time = 1; time <= 3; ++time)
    for (int i = 0; i < 2; ++i) {
      slices.push_back(at_height(2 * i, 1000 * time + 100 * i));
      slices.back().temporal = time;
    }
  const std::string scan = scan_of(folder, slices);
  const auto source = opened(scan);
  REQUIRE(source.steps.size() == 3);
  CHECK(source.times == std::vector<double>{0, 1, 2});
  CHECK(source.layout.dimensions[2] == 2);
  CHECK(values_of(source.steps[2])[12] == 3100 - 1024);
  app::VoxelComponent component;
  component.step = qnv::ShownStep{1, {}};
  CHECK(values_of(opened_as(scan, component))[0] == 2000 - 1024);
}

TEST_CASE("lists the series of a DICOM folder, the largest first") {
  ScratchFolder folder;
  std::vector<CtSlice> slices{at_height(0, 100), at_height(1, 200), at_height(2, 300)};
  for (int i = 0; i < 2; ++i) {
    slices.push_back(at_height(i, 700 + i));
    slices.back().series = "1.2.4";
    slices.back().series_number = 5;
  }
  slices.push_back(at_height(0, 900));  // another orientation, such as the picture for planning
  slices.back().orientation = "1\\0\\0\\0\\0\\-1";
  const std::string scan = scan_of(folder, slices);
  CHECK(opened(scan).layout.dimensions[2] == 3);
  app::VoxelComponent component;
  component.dataset = "CT-5";
  CHECK(values_of(opened_as(scan, component))[0] == 700 - 1024);
  component.dataset = "CT-2.2";
  CHECK(values_of(opened_as(scan, component))[0] == 900 - 1024);
  component.dataset = "CT-3";
  const auto wrong = app::open_volume(scan, {}, {nullptr, {}, component});
  REQUIRE(std::holds_alternative<std::string>(wrong));
  CHECK(std::get<std::string>(wrong).find("CT-2") != std::string::npos);
}

TEST_CASE("keeps patient data of DICOM files in their headers") {
  ScratchFolder folder;
  const std::string scan = scan_of(folder, {at_height(0, 100), at_height(1, 200)});
  const auto source = opened(scan);
  for (const auto& [key, value] : source.layout.metadata)
    for (const char* const secret : {"Secret", "SECRET", "1970", "1.2.3", "0102"}) {
      CHECK(key.find(secret) == std::string::npos);
      CHECK(value.find(secret) == std::string::npos);
    }
}

TEST_CASE("reads the encodings of DICOM data sets") {
  ScratchFolder folder;
  CtSlice slice;
  CHECK(values_of(opened(folder.write("explicit", slice.data().file())))[0] == 100 - 1024);
  CHECK(values_of(opened(folder.write("deflated", slice.data().file("1.2.840.10008.1.2.1.99", true))))[11] ==
        111 - 1024);
  CHECK(values_of(opened(folder.write("bare", string_of(slice.data().data()))))[0] == 100 - 1024);
  slice.form = DicomForms::implicit_little;
  CHECK(values_of(opened(folder.write("implicit", slice.data().file("1.2.840.10008.1.2"))))[1] == 101 - 1024);
  CHECK(values_of(opened(folder.write("wrong", slice.data().file("1.2.840.10008.1.2.1"))))[1] == 101 - 1024);
  slice.form = DicomForms::explicit_big;
  CHECK(values_of(opened(folder.write("big", slice.data().file("1.2.840.10008.1.2.2"))))[2] == 102 - 1024);
}

TEST_CASE("decodes RLE of DICOM files") {
  ScratchFolder folder;
  const CtSlice slice;
  DicomBuilder builder = slice.data();
  Bytes whole = builder.data();
  Bytes rle;
  put(rle, std::uint32_t{2});
  put(rle, std::uint32_t{64});
  put(rle, std::uint32_t{66});
  rle.resize(64);
  for (const int code : {-11, 0, 11}) {  // 12 high bytes of 0; 12 low bytes as they are
    put(rle, static_cast<std::int8_t>(code));
    if (code < 0) continue;
    if (code == 0) rle.back() = std::byte{0};
    for (int i = 0; code == 11 && i < 12; ++i) put(rle, static_cast<std::uint8_t>(100 + i));
  }
  // The native pixels are the last element; replace them.
  whole.resize(whole.size() - 24 - 12);
  DicomBuilder encoded;
  encoded.fragments({rle});
  const std::string file = DicomBuilder().file("1.2.840.10008.1.2.5") + string_of(whole + encoded.data());
  const auto source = opened(folder.write("rle", file));
  CHECK(values_of(source)[0] == 100 - 1024);
  CHECK(values_of(source)[11] == 111 - 1024);
  check_late_damage(folder, "damaged", bytes_of(file));
}

TEST_CASE("refuses damaged DICOM files with one message") {
  ScratchFolder folder;
  const CtSlice slice;
  const std::string file = slice.file();
  CHECK(problem_of(folder.write("cut", file.substr(0, file.size() - 2))) ==
        folder.path("cut") + ": DICOM: the pixels end after 22 bytes; expected 24");
  CHECK(problem_of(folder.write("none", file.substr(0, file.size() - 36))) ==
        folder.path("none") + ": DICOM: no pixels");
  CHECK(problem_of(folder.write("odd", slice.data().file("1.2.3"))) ==
        folder.path("odd") + ": DICOM: the transfer syntax 1.2.3 is unknown; expected uncompressed, RLE or JPEG");
  folder.write("text/a.txt", "hello");
  CHECK_FALSE(problem_of(folder.path("text")).empty());
  check_late_damage(folder, "changed", bytes_of(file));
}
