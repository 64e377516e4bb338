// Tests of encode, export, info and pictures of label volumes, as a user runs them.
#include "app/formats/volume/volume.h"
#include "qnv/sampling/volume/label_vectors.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "render/image/image.h"
#include "tests/app/commands/vector_commands.h"

#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

// Ball with the label `inner` in a ball with the label 7, in NRRD.
template <class T>
std::string nrrd_labels(const char* type, T inner, const std::string& more = {}) {
  std::string text = std::string("NRRD0004\ntype: ") + type +
                     "\ndimension: 3\nsizes: 30 28 26\nspacings: 1 1 2\nendian: little\nencoding: raw\n" + more + "\n";
  for (int z = 0; z < 26; ++z)
    for (int y = 0; y < 28; ++y)
      for (int x = 0; x < 30; ++x) {
        const double u = x / 14.5 - 1, v = y / 13.5 - 1, w = z / 12.5 - 1, r = u * u + v * v + w * w;
        const T label = r > 0.8 ? T{0} : r > 0.3 ? T{7} : inner;
        text.append(reinterpret_cast<const char*>(&label), sizeof label);
      }
  return text;
}

std::vector<double> numbers_in_file(const std::string& path, bool* labels = nullptr) {
  auto opened = open_volume(path);
  const auto* problem = std::get_if<std::string>(&opened);
  INFO((problem ? *problem : path));
  REQUIRE_FALSE(problem);
  const auto& source = std::get<qnv::VolumeSource>(opened);
  if (labels) *labels = source.layout.labels;
  const std::size_t slice = qnv::slice_voxels(source.layout);
  std::vector<std::byte> stored(slice * qnv::size_of(source.layout.type));
  std::vector<double> numbers(qnv::voxel_count(source.layout));
  for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z) {
    REQUIRE(source.read(z, stored));
    qnv::stored_numbers(source.layout, stored, std::span(numbers).subspan(z * slice, slice));
  }
  for (double& number : numbers) number = number * source.layout.slope + source.layout.intercept;
  return numbers;
}

}  // namespace

TEST_CASE("encode: --labels keeps labels, and every format gives them back") {
  const ScratchFolder folder;
  const std::string stream = folder.path("a.qnv");
  for (const std::string& given :
       {nrrd_labels<std::uint8_t>("uint8", 200), nrrd_labels<std::int16_t>("int16", -9),
        nrrd_labels<std::uint32_t>("uint32", 4'000'000'001u), nrrd_labels<double>("double", 3e9)}) {
    const std::string volume = folder.write("a.nrrd", given);
    const Run encoded = run("encode --labels yes " + quoted(volume) + " " + quoted(stream));
    INFO(encoded.output);
    REQUIRE(encoded.status == kDone);
    CHECK(encoded.output.find("labels of 21,840 voxels, exact") != std::string::npos);
    const std::vector<double> truth = numbers_in_file(volume);
    for (const char* extension : {"nrrd", "vti", "nii", "fits"}) {
      const std::string out = folder.path(std::string("out.") + extension);
      const Run exported = run("export " + quoted(stream) + " " + quoted(out));
      INFO(exported.output);
      REQUIRE(exported.status == kDone);
      bool labels = false;
      CHECK(numbers_in_file(out, &labels) == truth);
      CHECK(labels == (std::string(extension) == "nii"));  // NIFTI_INTENT_LABEL
    }
  }
  const Run info = run("info " + quoted(stream));
  CHECK(info.output.find("wrong labels") != std::string::npos);
  CHECK(info.output.find("level 0, chunks ") != std::string::npos);
  const Run refused = run("encode --labels yes " + quoted(folder.write("b.nrrd", nrrd_labels<float>("float", 0.5f))) +
                          " " + quoted(stream));
  CHECK(refused.status != kDone);
  CHECK(refused.output.find("expected whole numbers") != std::string::npos);
  CHECK(run("encode --labels maybe " + quoted(folder.path("a.nrrd")) + " " + quoted(stream)).status != kDone);
}

TEST_CASE("encode: Files that state labels are encoded as labels, unless --labels no") {
  const ScratchFolder folder;
  const std::string stream = folder.path("a.qnv");
  const std::string slicer =
      folder.write("a.seg.nrrd", nrrd_labels<std::uint8_t>("uint8", 3, "Segment0_LabelValue:=7\n"));
  REQUIRE(run("encode " + quoted(slicer) + " " + quoted(stream)).output.find("labels of") != std::string::npos);
  const std::string nifti = folder.path("a.nii");
  REQUIRE(run("export " + quoted(stream) + " " + quoted(nifti)).status == kDone);
  CHECK(run("encode " + quoted(nifti) + " " + quoted(stream)).output.find("labels of") != std::string::npos);
  CHECK(run("encode --labels no " + quoted(nifti) + " " + quoted(stream)).output.find("values of") !=
        std::string::npos);
}

TEST_CASE("snapshot: Slices of labels have the colours of labels alone") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_labels<std::uint32_t>("uint32", 4'000'000'001u));
  const std::string stream = folder.path("a.qnv"), picture = folder.path("a.png");
  REQUIRE(run("encode --labels yes " + quoted(volume) + " " + quoted(stream)).status == kDone);
  for (const std::string& shown : {quoted(stream), quoted(volume) + " --labels yes"}) {
    const Run drawn = run("--snapshot " + quoted(picture) + " " + shown +
                          " --size 300x300 --slice z=50% --slices-alone --orthographic --camera "
                          "'position=15,14,90 orientation=0,0,1,0 height=20' --background '0,0,0'");
    INFO(drawn.output);
    REQUIRE(drawn.status == kDone);
    const std::string bytes = folder.read("a.png");
    const auto decoded = render::decode_image(std::as_bytes(std::span(bytes)));
    const auto* image = std::get_if<render::Image>(&decoded);
    REQUIRE(image);
    std::size_t inner = 0, outer = 0;
    const qnv::Rgb8 in = qnv::label_color(4'000'000'001.0), out = qnv::label_color(7);
    for (std::size_t i = 0; i + 2 < image->pixels.size(); i += image->components) {
      const auto is = [&](const qnv::Rgb8& c) {
        return image->pixels[i] == c.r && image->pixels[i + 1] == c.g && image->pixels[i + 2] == c.b;
      };
      inner += is(in) ? 1 : 0;
      outer += is(out) ? 1 : 0;
    }
    CHECK(inner > 5000);
    CHECK(outer > 5000);
  }
}

TEST_CASE("encode: joins label volumes to a time series, and export and pictures show its steps") {
  const ScratchFolder folder;
  std::string all, names;
  std::vector<std::vector<double>> truth;
  for (std::uint8_t step = 0; step < 10; ++step) {
    const auto inner = static_cast<std::uint8_t>(step < 4 ? 3 : 40 + step);
    const std::string file =
        folder.write("run" + std::to_string(step) + ".nrrd", nrrd_labels<std::uint8_t>("uint8", inner));
    names += quoted(file) + " ";
    truth.push_back(numbers_in_file(file));
    all.append(
        nrrd_labels<std::uint8_t>("uint8", inner).substr(nrrd_labels<std::uint8_t>("uint8", inner).size() - 21840));
  }
  const std::string whole =
      folder.write("all.nrrd",
                   "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 30 28 26 10\nkinds: domain domain domain time\n"
                   "spacings: 1 1 2 1\nendian: little\nencoding: raw\n\n" +
                       all);
  const std::string stream = folder.path("a.qnv"), out = folder.path("out.nrrd"), picture = folder.path("a.png");
  for (const std::string& input : {names, quoted(whole)}) {
    const Run encoded = run("encode --labels yes " + input + " " + quoted(stream));
    INFO(encoded.output);
    REQUIRE(encoded.status == kDone);
    CHECK(encoded.output.find("10 steps of labels of") != std::string::npos);
    for (const std::size_t step : {0u, 3u, 4u, 9u}) {
      const Run exported = run("export --time " + std::to_string(step) + " " + quoted(stream) + " " + quoted(out));
      INFO(exported.output);
      REQUIRE(exported.status == kDone);
      CHECK(numbers_in_file(out) == truth[step]);
    }
  }
  CHECK(run("export " + quoted(stream) + " " + quoted(out)).output.find("10 steps of 30 x 28 x 26 voxels, exact") !=
        std::string::npos);
  std::vector<std::string> pictures;
  for (const char* time : {"0", "3", "9"}) {
    const Run drawn = run("--snapshot " + quoted(picture) + " --time " + time + " " + quoted(stream) +
                          " --size 120x120 --slice z=50% --slices-alone");
    INFO(drawn.output);
    REQUIRE(drawn.status == kDone);
    pictures.push_back(folder.read("a.png"));
  }
  CHECK(pictures[0] == pictures[1]);
  CHECK(pictures[0] != pictures[2]);
}
