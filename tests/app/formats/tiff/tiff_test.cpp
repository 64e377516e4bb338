#include "app/formats/tiff/tiff_layout.h"
#include "tests/app/formats/tiff/tiff_builder.h"
#include "tests/app/shared_facts.h"

using namespace gs;
using namespace gs::test;

namespace {

Bytes bytes_from(int first, int count) {
  Bytes bytes;
  for (int i = 0; i < count; ++i) put(bytes, static_cast<std::uint8_t>(first + i));
  return bytes;
}

/// Pages of 3 x 2 pixels; page k begins with the value 10 k.
std::vector<TiffPageOf> pages_of(int count, const std::string& description = {}) {
  std::vector<TiffPageOf> pages;
  for (int i = 0; i < count; ++i) {
    TiffPageOf page;
    page.pixels = bytes_from(10 * i, 6);
    if (i == 0) page.description = description;
    pages.push_back(page);
  }
  return pages;
}

qnv::VolumeSource opened_with(const std::string& path, const app::VoxelComponent& component) {
  auto result = app::open_volume(path, {}, {nullptr, {}, component});
  if (const auto* problem = std::get_if<std::string>(&result)) FAIL(*problem);
  return std::get<qnv::VolumeSource>(std::move(result));
}

app::VoxelComponent channel(std::uint64_t number) {
  app::VoxelComponent component;
  component.channel = number;
  return component;
}

float first_of(const qnv::VolumeSource& source, std::size_t slice) { return values_of(source)[slice * 6]; }

std::string ome(const std::string& attributes, const std::string& inside) {
  return "<?xml version=\"1.0\"?><OME xmlns=\"http://www.openmicroscopy.org/Schemas/OME/2016-06\"><Image "
         "ID=\"Image:0\">"
         "<Pixels ID=\"Pixels:0\" Type=\"uint8\" SizeX=\"3\" SizeY=\"2\" " +
         attributes + ">" + inside + "</Pixels></Image></OME>";
}

}  // namespace

TEST_CASE("reads the pages of a TIFF file as slices") {
  ScratchFolder folder;
  for (const bool big_endian : {false, true})
    for (const bool big_tiff : {false, true}) {
      const auto source = opened(folder.write("a.tif", tiff_file(pages_of(4), big_endian, big_tiff)));
      CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{3, 2, 4});
      CHECK(values_of(source)[7] == 11);
      CHECK(first_of(source, 3) == 30);
    }
}

TEST_CASE("reads the numbers of TIFF pixels in all types") {
  ScratchFolder folder;
  const auto check = [&](auto kind, std::uint16_t format) {
    using T = decltype(kind);
    for (const bool big_endian : {false, true}) {
      TiffPageOf page;
      page.bits = sizeof(T) * 8;
      page.format = format;
      for (const int value : {0, 1, 2, 100, 50, 7}) {
        if (big_endian)
          put_big(page.pixels, static_cast<T>(value));
        else
          put(page.pixels, static_cast<T>(value));
      }
      INFO(sizeof(T) << ' ' << format);
      CHECK(values_of(opened(folder.write("a.tif", tiff_file({page}, big_endian)))) ==
            std::vector<float>{0, 1, 2, 100, 50, 7});
    }
  };
  check(std::uint8_t{}, 1);
  check(std::int8_t{}, 2);
  check(std::uint16_t{}, 1);
  check(std::int16_t{}, 2);
  check(std::uint32_t{}, 1);
  check(std::int32_t{}, 2);
  check(std::uint64_t{}, 1);
  check(std::int64_t{}, 2);
  check(float{}, 3);
  check(double{}, 3);
  TiffPageOf bits;
  bits.bits = 1;
  bits.photometric = 0;  // 0 is white
  bits.pixels = {std::byte{0x40}, std::byte{0x80}};
  CHECK(values_of(opened(folder.write("a.tif", tiff_file({bits})))) == std::vector<float>{1, 0, 1, 0, 1, 1});
}

TEST_CASE("takes integers of 32 bits in TIFF files for labels") {
  ScratchFolder folder;
  TiffPageOf page;
  page.bits = 32;
  for (int i = 0; i < 6; ++i) put(page.pixels, std::uint32_t(i));
  CHECK(opened(folder.write("a.tif", tiff_file({page}))).layout.labels);
  CHECK_FALSE(opened(folder.write("b.tif", tiff_file(pages_of(1)))).layout.labels);
}

TEST_CASE("reads colours of TIFF files") {
  ScratchFolder folder;
  TiffPageOf page;
  page.samples = 3;
  page.photometric = 2;
  page.pixels = bytes_from(0, 18);
  const auto source = opened(folder.write("a.tif", tiff_file({page})));
  CHECK(source.layout.colors);
  REQUIRE(source.components.size() == 3);
  CHECK(values_of(source.components[1]) == std::vector<float>{1, 4, 7, 10, 13, 16});
  page.bits = 16;
  page.pixels.clear();
  for (int i = 0; i < 18; ++i) put(page.pixels, static_cast<std::uint16_t>(i << 8 | 0x55));
  CHECK(values_of(opened(folder.write("b.tif", tiff_file({page}))).components[1]) ==
        std::vector<float>{1, 4, 7, 10, 13, 16});
}

TEST_CASE("reads the axes of hyperstacks of ImageJ") {
  ScratchFolder folder;
  const std::string text =
      "ImageJ=1.53t\nimages=12\nchannels=2\nslices=3\nframes=2\nhyperstack=true\nunit=\\u00B5m\nspacing=0.7\n"
      "finterval=2.5\n";
  auto pages = pages_of(12, text);
  for (auto& page : pages) page.resolution = 4;
  const std::string path = folder.write("a.tif", tiff_file(pages));
  const auto source = opened(path);
  CHECK(source.layout.dimensions == std::array<std::uint32_t, 3>{3, 2, 3});
  CHECK(source.layout.axes[0].x == Approx(0.25));
  CHECK(source.layout.axes[1].y == Approx(0.25));
  CHECK(source.layout.axes[2].z == Approx(0.7));
  REQUIRE(source.steps.size() == 2);
  CHECK(source.times == std::vector<double>{0, 2.5});
  CHECK(first_of(source.steps[1], 2) == 100);  // page (1 * 3 + 2) * 2
  CHECK(first_of(opened_with(path, channel(1)).steps[0], 1) == 30);
}

TEST_CASE("reads stacks of ImageJ with one directory") {
  ScratchFolder folder;
  for (const bool big_endian : {false, true}) {
    TiffPageOf page;
    page.bits = 16;
    page.description = "ImageJ=1.53t\nimages=3\nslices=3\n";
    Bytes pixels;
    for (int i = 0; i < 18; ++i) {
      if (big_endian)
        put_big(pixels, static_cast<std::uint16_t>(300 + i));
      else
        put(pixels, static_cast<std::uint16_t>(300 + i));
    }
    page.pixels = pixels;
    const auto source = opened(folder.write("a.tif", tiff_file({page}, big_endian)));
    CHECK(source.layout.dimensions[2] == 3);
    CHECK(first_of(source, 2) == 312);
  }
}

TEST_CASE("reads images of OME-TIFF by their planes") {
  ScratchFolder folder;
  const std::string sizes =
      "SizeZ=\"2\" SizeC=\"2\" SizeT=\"2\" PhysicalSizeX=\"0.5\" PhysicalSizeY=\"0.25\" PhysicalSizeZ=\"2\" "
      "TimeIncrement=\"3\" ";
  const std::string channels = "<Channel ID=\"a\" Name=\"DAPI\"/><Channel ID=\"b\" Name=\"GFP\"/>";
  SECTION("in the order of the dimensions") {
    const std::string text = ome(sizes + "DimensionOrder=\"XYCZT\"", channels + "<TiffData/>");
    const std::string path = folder.write("a.tif", tiff_file(pages_of(8, text)));
    const auto source = opened(path);
    REQUIRE(source.steps.size() == 2);
    CHECK(source.times == std::vector<double>{0, 3});
    CHECK(source.layout.axes[0].x == 0.5f);
    CHECK(source.layout.axes[1].y == 0.25f);
    CHECK(source.layout.axes[2].z == 2);
    CHECK(first_of(source.steps[1], 1) == 60);
    CHECK(first_of(opened_with(path, channel(1)).steps[0], 1) == 30);
    app::VoxelComponent wrong = channel(2);
    CHECK(std::holds_alternative<std::string>(app::open_volume(path, {}, {nullptr, {}, wrong})));
  }
  SECTION("in an order of its own") {
    std::string planes;
    for (int i = 0; i < 8; ++i)
      planes += "<TiffData IFD=\"" + std::to_string(7 - i) + "\" FirstZ=\"" + std::to_string(i % 2) + "\" FirstC=\"" +
                std::to_string(i / 2 % 2) + "\" FirstT=\"" + std::to_string(i / 4) + "\" PlaneCount=\"1\"/>";
    const std::string text = ome(sizes + "DimensionOrder=\"XYZCT\"", channels + planes);
    const auto source = opened(folder.write("a.tif", tiff_file(pages_of(8, text))));
    CHECK(first_of(source.steps[0], 0) == 70);
    CHECK(first_of(source.steps[0], 1) == 60);
    CHECK(first_of(source.steps[1], 0) == 30);
  }
  SECTION("without planes of other files") {
    const std::string text = ome("SizeZ=\"2\" SizeC=\"1\" SizeT=\"1\" DimensionOrder=\"XYZCT\"",
                                 "<TiffData IFD=\"0\"><UUID FileName=\"a.tif\">u</UUID></TiffData>"
                                 "<TiffData IFD=\"0\" FirstZ=\"1\"><UUID FileName=\"b.tif\">v</UUID></TiffData>");
    const auto source = opened(folder.write("a.tif", tiff_file(pages_of(1, text))));
    CHECK(source.layout.dimensions[2] == 2);
    CHECK(first_of(source, 1) == 0);
  }
}

TEST_CASE("bounds the work for hostile OME descriptions") {
  std::size_t missing = 0;
  const std::string huge = ome("SizeZ=\"99999999\" SizeC=\"99999999\" SizeT=\"99999999\"", "<TiffData/>");
  CHECK(app::ome_images(huge, 5, "a", missing).empty());
  std::string blocks;
  for (int i = 0; i < 5000; ++i) blocks += "<TiffData IFD=\"0\" PlaneCount=\"1000000\"/>";
  CHECK(app::ome_images(ome("SizeZ=\"1000000\" SizeC=\"1\" SizeT=\"1\"", blocks), 1'000'000, "a", missing).size() == 1);
}

TEST_CASE("reads units of TIFF files") {
  CHECK(app::plain_unit("\\u00B5m") == "um");
  CHECK(app::plain_unit("micron") == "um");
  CHECK(app::plain_unit("\xc2\xb5m") == "um");
  CHECK(app::plain_unit("nm") == "nm");
  CHECK(app::plain_unit("pixel").empty());
  CHECK(app::plain_unit("\x01\x02").empty());
}

TEST_CASE("reads damaged TIFF files without harm") {
  ScratchFolder folder;
  check_late_damage(folder, "a.tif", bytes_of(tiff_file(pages_of(2, "ImageJ=1\nimages=2\nslices=2\n"))));
}

TEST_CASE("agrees with tifffile about shared TIFF files") {
  const std::string folder = shared_data("tiff");
  if (folder.empty()) return;
  int files = 0;
  for (const SharedFact& fact : shared_facts(folder + "README.md")) {
    INFO(fact.file);
    const auto source = opened(folder + fact.file);
    std::vector<float> all;
    if (source.components.empty()) all = values_of(source);
    for (const auto& component : source.components)
      for (const float value : values_of(component)) all.push_back(value);
    double sum = 0;
    for (const float value : all) sum += double{value};
    CHECK(*std::ranges::min_element(all) == number_in(fact.text, " min "));
    CHECK(*std::ranges::max_element(all) == number_in(fact.text, " max "));
    CHECK(sum / static_cast<double>(all.size()) == Approx(*number_in(fact.text, " mean ")).epsilon(1e-5));
    ++files;
  }
  CHECK(files == 5);
  CHECK(opened(folder + "platynereis_gt.tif").layout.labels);
  CHECK(opened(folder + "bead_crop.tif").layout.axes[2].z == Approx(0.125));
}
