// Tests of encode, export and pictures of volumes with several numbers per voxel, as a user runs them.
#include "render/image/image.h"
#include "tests/app/commands/vector_commands.h"
#include "tests/qnv/value_streams.h"

#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

constexpr int kVectorEdge = 18;

// Voxels with three numbers each.
template <class T>
std::string nrrd_vectors(const char* type, double scale, double shift) {
  std::string text = std::string("NRRD0004\ntype: ") + type +
                     "\ndimension: 4\nsizes: 3 18 18 18\nkinds: vector domain domain domain\nspacings: nan 1 1 2\n"
                     "endian: little\nencoding: raw\n\n";
  for (int z = 0; z < kVectorEdge; ++z)
    for (int y = 0; y < kVectorEdge; ++y)
      for (int x = 0; x < kVectorEdge; ++x)
        for (int c = 0; c < 3; ++c) {
          const double place = c == 0 ? x : c == 1 ? y - x : z * y / 18.0;
          const T value = static_cast<T>(std::sin(place / 5) * scale + shift);
          text.append(reinterpret_cast<const char*>(&value), sizeof value);
        }
  return text;
}

std::vector<std::vector<float>> rows_in_file(const std::string& path) {
  const qnv::VolumeSource source = opened_volume(path);
  std::vector<std::vector<float>> all;
  if (source.components.empty()) all.push_back(test::values_in(source));
  for (const qnv::VolumeSource& one : source.components) all.push_back(test::values_in(one));
  return all;
}

}  // namespace

TEST_CASE("encode: keeps all numbers of a voxel, and export writes them") {
  const ScratchFolder folder;
  const std::string stream = folder.path("a.qnv");
  for (const std::string& given : {nrrd_vectors<std::uint8_t>("uint8", 100, 120), nrrd_vectors<float>("float", 3, 0),
                                   nrrd_vectors<std::int16_t>("int16", 9000, 0)}) {
    const std::string volume = folder.write("a.nrrd", given);
    const Run encoded = run("encode --lossless " + quoted(volume) + " " + quoted(stream));
    INFO(encoded.output);
    REQUIRE(encoded.status == kDone);
    const auto truth = rows_in_file(volume);
    REQUIRE(truth.size() == 3);
    for (const char* extension : {"nrrd", "vti", "nii"}) {
      const std::string out = folder.path(std::string("out.") + extension);
      const Run exported = run("export " + quoted(stream) + " " + quoted(out));
      INFO(exported.output);
      REQUIRE(exported.status == kDone);
      CHECK(exported.output.find("voxels of 3 numbers, exact") != std::string::npos);
      CHECK(rows_in_file(out) == truth);
    }
    const std::string one = folder.path("one.fits");
    REQUIRE(run("export --component 1 " + quoted(stream) + " " + quoted(one)).status == kDone);
    CHECK(rows_in_file(one) == std::vector<std::vector<float>>{truth[1]});
    const std::string direct = folder.path("direct.nii");
    REQUIRE(run("export " + quoted(volume) + " " + quoted(direct)).status == kDone);
    CHECK(rows_in_file(direct) == truth);
    const std::string length = folder.path("length.nrrd");
    REQUIRE(run("export --component magnitude " + quoted(stream) + " " + quoted(length)).status == kDone);
    CHECK(static_cast<double>(rows_in_file(length)[0][40]) ==
          Approx(std::sqrt(std::pow(truth[0][40], 2) + std::pow(truth[1][40], 2) + std::pow(truth[2][40], 2))));
  }
  CHECK(run("export " + quoted(stream) + " " + quoted(folder.path("a.fits"))).output.find("--component") !=
        std::string::npos);
  CHECK(run("export --component 3 " + quoted(stream) + " " + quoted(folder.path("b.nrrd")))
            .output.find("expected 0 to 2") != std::string::npos);
  const std::string all = run("info " + quoted(stream)).output;
  CHECK(all.find("components") != std::string::npos);
  REQUIRE(run("encode --component 2 " + quoted(folder.path("a.nrrd")) + " " + quoted(stream)).status == kDone);
  const std::string one = run("info " + quoted(stream)).output;
  CHECK(one.find("components") == std::string::npos);
  // The levels count the clusters of all components.
  const auto bytes_of_levels = [](const std::string& text) {
    long bytes = 0;
    for (std::size_t at = 0; (at = text.find("  level ", at)) != std::string::npos; ++at)
      bytes += std::stol(text.substr(text.find("bytes ", at) + 6));
    return bytes;
  };
  CHECK(bytes_of_levels(one) > 0);
  CHECK(bytes_of_levels(all) > 2 * bytes_of_levels(one));
}

TEST_CASE("snapshot: --component selects the numbers of a stream") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_vectors<std::int16_t>("int16", 9000, 0));
  const std::string stream = folder.path("a.qnv");
  REQUIRE(run("encode --lossless " + quoted(volume) + " " + quoted(stream)).status == kDone);
  std::vector<std::string> pictures;
  for (const char* component : {"0", "1", "magnitude"})
    for (const std::string& shown : {stream, volume}) {
      const std::string picture = folder.path("a.png");
      const Run drawn = run("--snapshot " + quoted(picture) + " --component " + component + " " + quoted(shown) +
                            " --size 120x120 --slice z=50% --slices-alone");
      INFO(drawn.output);
      REQUIRE(drawn.status == kDone);
      pictures.push_back(folder.read("a.png"));
    }
  CHECK(pictures[0] != pictures[2]);
  CHECK(pictures[0] != pictures[4]);
}

TEST_CASE("encode: keeps colours of voxels, draws them, and export writes them") {
  const ScratchFolder folder;
  const std::string stream = folder.path("a.qnv");
  for (const int count : {3, 4}) {
    std::string text = std::string("NRRD0004\ntype: uint8\ndimension: 4\nsizes: ") + std::to_string(count) +
                       " 30 28 26\nkinds: " + (count == 3 ? "RGB-color" : "RGBA-color") +
                       " domain domain domain\nencoding: raw\n\n";
    for (int z = 0; z < 26; ++z)
      for (int y = 0; y < 28; ++y)
        for (int x = 0; x < 30; ++x) {
          // A red ball in a green box.
          const int far = (x - 15) * (x - 15) + (y - 14) * (y - 14) + (z - 13) * (z - 13);
          const bool box = x > 2 && x < 27 && y > 2 && y < 25 && z > 2 && z < 12;
          text += far < 90 ? std::string{'\xc8', '\x14', '\x0a'}
                  : box    ? std::string{'\x0a', '\x96', '\x14'}
                           : std::string(3, '\0');
          if (count == 4) text += '\xff';
        }
    const std::string volume = folder.write("a.nrrd", text);
    const Run encoded = run("encode " + quoted(volume) + " " + quoted(stream));
    INFO(encoded.output);
    REQUIRE(encoded.status == kDone);
    CHECK(info(stream).contains("colors"));
    const auto truth = rows_in_file(volume);
    REQUIRE(truth.size() == static_cast<std::size_t>(count));
    for (const char* extension : {"nrrd", "vti", "nii"})
      for (const std::string& from : {stream, volume}) {
        const std::string out = folder.path(std::string("out.") + extension), again = folder.path("again.qnv");
        const Run exported = run("export " + quoted(from) + " " + quoted(out));
        INFO(exported.output);
        REQUIRE(exported.status == kDone);
        CHECK(exported.output.find("voxels of colours, exact") != std::string::npos);
        CHECK(rows_in_file(out) == truth);
        REQUIRE(run("encode " + quoted(out) + " " + quoted(again)).status == kDone);
        CHECK(info(again).contains("colors"));
      }
    const std::string red = folder.path("red.nrrd");
    REQUIRE(run("export --component 0 " + quoted(stream) + " " + quoted(red)).status == kDone);
    CHECK(rows_in_file(red) == std::vector<std::vector<float>>{truth[0]});
    // Pictures of the stream and of the file have red and green pixels.
    for (const std::string& shown : {stream, volume})
      for (const char* look : {"", " --slice z=9 --slices-alone"}) {
        const std::string picture = folder.path("a.png");
        const Run drawn =
            run("--snapshot " + quoted(picture) + " " + quoted(shown) + " --size 160x160 --background 0,0,0" + look);
        INFO(drawn.output);
        REQUIRE(drawn.status == kDone);
        const std::string bytes = folder.read("a.png");
        const auto decoded = render::decode_image(std::as_bytes(std::span(bytes)));
        REQUIRE(std::holds_alternative<render::Image>(decoded));
        const auto& image = std::get<render::Image>(decoded);
        std::size_t red_pixels = 0, green_pixels = 0;
        for (std::size_t i = 0; i + 2 < image.pixels.size(); i += image.components) {
          red_pixels += image.pixels[i] > 2 * image.pixels[i + 1] + 20 ? 1 : 0;
          green_pixels += image.pixels[i + 1] > 2 * image.pixels[i] + 20 ? 1 : 0;
        }
        INFO(shown << look);
        CHECK(red_pixels > 300);
        CHECK(green_pixels > 300);
      }
  }
}
