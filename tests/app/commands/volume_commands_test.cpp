// Tests of encode, export, info and pictures of volumes, as a user runs them.
#include "app/formats/volume/volume.h"
#include "qnv/sampling/volume/volume_slices.h"
#include "render/image/image.h"
#include "tests/app/commands/vector_commands.h"

#include <glm/geometric.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <variant>
#include <vector>

using namespace gs;
using namespace gs::app;
using namespace gs::test;

namespace {

constexpr std::uint32_t kEdge = 24;

// Soft ball in NRRD, with axes at right angles.
template <class T>
std::string nrrd_ball(const char* type, double height, const std::string& more = {}) {
  std::string text = std::string("NRRD0004\ntype: ") + type +
                     "\ndimension: 3\nspace dimension: 3\nsizes: 24 24 24\nspace directions: (0.5,0,0) (0,0,2) "
                     "(0,-1,0)\nspace origin: (1,2,3)\nendian: little\nencoding: raw\n" +
                     more + "\n";
  for (std::uint32_t z = 0; z < kEdge; ++z)
    for (std::uint32_t y = 0; y < kEdge; ++y)
      for (std::uint32_t x = 0; x < kEdge; ++x) {
        const double u = x / 11.5 - 1, v = y / 11.5 - 1, w = z / 11.5 - 1, r = u * u + v * v + w * w;
        const T value = static_cast<T>(r > 0.8 ? 0 : height * (1 - r));
        text.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
  return text;
}

struct ReadVolume {
  explicit ReadVolume(const std::string& path) {
    auto opened = open_volume(path);
    const auto* problem = std::get_if<std::string>(&opened);
    INFO((problem ? *problem : path));
    REQUIRE_FALSE(problem);
    source = std::move(std::get<qnv::VolumeSource>(opened));
    std::vector<std::byte> scratch;
    values.resize(qnv::voxel_count(source.layout));
    const std::size_t slice = qnv::slice_voxels(source.layout);
    for (std::uint32_t z = 0; z < source.layout.dimensions[2]; ++z)
      REQUIRE(qnv::read_slice(source, z, scratch, std::span(values).subspan(z * slice, slice)));
  }
  [[nodiscard]] glm::dvec3 origin() const { return source.layout.base + source.layout.origin; }
  qnv::VolumeSource source;
  std::vector<float> values;
};

}  // namespace

TEST_CASE("encode: keeps the values of a volume, and export writes them in every format") {
  const ScratchFolder folder;
  const std::string stream = folder.path("a.qnv");
  for (const std::string& given : {nrrd_ball<std::uint8_t>("uint8", 250), nrrd_ball<std::uint16_t>("uint16", 60'000),
                                   nrrd_ball<std::int16_t>("int16", -30'000), nrrd_ball<std::uint32_t>("uint32", 4e9),
                                   nrrd_ball<std::int8_t>("int8", -120), nrrd_ball<float>("float", 0.01)}) {
    const std::string volume = folder.write("a.nrrd", given);
    const Run encoded = run("encode --lossless " + quoted(volume) + " " + quoted(stream));
    INFO(encoded.output);
    REQUIRE(encoded.status == kDone);
    CHECK(encoded.output.find("values of 13,824 voxels, exact") != std::string::npos);
    const ReadVolume truth(volume);
    for (const char* extension : {"nrrd", "vti", "nii", "nii.gz", "fits"}) {
      const std::string out = folder.path(std::string("out.") + extension);
      const Run exported = run("export " + quoted(stream) + " " + quoted(out));
      INFO(exported.output);
      REQUIRE(exported.status == kDone);
      CHECK(exported.output.find("(24 x 24 x 24 voxels, exact)") != std::string::npos);
      const ReadVolume back(out);
      CHECK(back.values == truth.values);
      for (std::size_t axis = 0; axis < 3; ++axis)
        CHECK(glm::length(back.source.layout.axes[axis]) == Approx(glm::length(truth.source.layout.axes[axis])));
      if (extension == std::string("fits")) continue;  // its axes are those of the image
      CHECK(back.source.layout.axes == truth.source.layout.axes);
      CHECK(glm::distance(back.origin(), truth.origin()) < 1e-6);
    }
  }
  // A volume file converts without a stream, too.
  const std::string out = folder.path("direct.nii.gz");
  REQUIRE(run("export " + quoted(folder.path("a.nrrd")) + " " + quoted(out)).status == kDone);
  CHECK(ReadVolume(out).values == ReadVolume(folder.path("a.nrrd")).values);
}

TEST_CASE("encode: --error limits the difference of every voxel, and info states it") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_ball<std::uint16_t>("uint16", 3000)),
                    stream = folder.path("a.qnv"), out = folder.path("out.nrrd");
  for (const char* error : {"40", "1%"}) {
    REQUIRE(run(std::string("encode --error ") + error + " " + quoted(volume) + " " + quoted(stream)).status == kDone);
    const nlohmann::json facts = info(stream);
    CHECK(facts["payload"] == "values");
    CHECK(facts["exact"] == false);
    CHECK(facts["level_of_values"] == 0);
    CHECK(facts["error"].get<double>() <= 40);
    CHECK(facts["error"].get<double>() > 2);
    REQUIRE(run("export " + quoted(stream) + " " + quoted(out)).status == kDone);
    const ReadVolume truth(volume), back(out);
    double most = 0;
    for (std::size_t i = 0; i < truth.values.size(); ++i)
      most = std::max(most, static_cast<double>(std::abs(truth.values[i] - back.values[i])));
    CHECK(most <= facts["error"].get<double>());
  }
  for (const char* wrong : {"--error -1", "--error 120%", "--error x", "--error 1 --lossless",
                            "--lossless --max-bytes 10k", "--error 1 --method records", "--method values --vectors 9",
                            "--parity 0.6", "--parity x", "--parity 0.1 --method octree"}) {
    INFO(wrong);
    CHECK(run(std::string("encode ") + wrong + " " + quoted(volume) + " " + quoted(stream)).status == kUsage);
  }
  CHECK(run("encode --method values " + quoted(folder.write("b.wrl", kBall)) + " " + quoted(stream)).status == kFailed);
}

TEST_CASE("encode: keeps every nth voxel of a volume with --most-voxels") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_ball<std::uint16_t>("uint16", 60'000));
  const std::string stream = folder.path("a.qnv"), out = folder.path("out.nrrd");
  const Run encoded = run("encode --lossless --most-voxels 600 " + quoted(volume) + " " + quoted(stream));
  INFO(encoded.output);
  REQUIRE(encoded.status == kDone);
  CHECK(encoded.output.find("values of 512 voxels, exact") != std::string::npos);
  REQUIRE(run("export " + quoted(stream) + " " + quoted(out)).status == kDone);
  const ReadVolume fine(volume), coarse(out);
  REQUIRE(coarse.source.layout.dimensions == std::array<std::uint32_t, 3>{8, 8, 8});
  CHECK(coarse.origin() == fine.origin());
  CHECK(coarse.source.layout.axes[0] == 3.0f * fine.source.layout.axes[0]);
  CHECK(coarse.values[(4 * 8 + 5) * 8 + 2] == fine.values[(12 * kEdge + 15) * kEdge + 6]);
  REQUIRE(run("encode --lossless --most-voxels 1M " + quoted(volume) + " " + quoted(stream)).status == kDone);
  REQUIRE(run("export " + quoted(stream) + " " + quoted(out)).status == kDone);
  CHECK(ReadVolume(out).values == fine.values);
  const std::string second = folder.write("b.nrrd", nrrd_ball<std::uint16_t>("uint16", 30'000));
  const Run series =
      run("encode --lossless --most-voxels 600 " + quoted(volume) + " " + quoted(second) + " " + quoted(stream));
  INFO(series.output);
  CHECK(series.output.find("2 steps of values of 512 voxels, exact") != std::string::npos);
  const std::string mesh = folder.write("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const Run refused = run("encode --most-voxels 9 " + quoted(mesh) + " " + quoted(stream));
  CHECK(refused.status == kFailed);
  CHECK(refused.output.find("--most-voxels applies to volumes only") != std::string::npos);
}

TEST_CASE("snapshot: says that a volume of one value is invisible") {
  const ScratchFolder folder;
  const std::string flat = folder.write(
      "flat.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: ascii\n\n7 7 7 7 7 7 7 7\n");
  const Run drawn = run("--snapshot " + quoted(folder.path("a.png")) + " --size 32x32 " + quoted(flat));
  INFO(drawn.output);
  CHECK(drawn.status == kDone);
  CHECK(drawn.output.find("have one value, so it is invisible") != std::string::npos);
  const std::string picture = folder.write(
      "flat.nrrd", "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 4 1\nencoding: ascii\n\n7 7 7 7 7 7 7 7\n");
  CHECK(
      run("--snapshot " + quoted(folder.path("a.png")) + " --size 32x32 " + quoted(picture)).output.find("invisible") ==
      std::string::npos);
}

TEST_CASE("info: describes a volume larger than memory at a coarser level, without an error") {
  const ScratchFolder folder;
  std::string volume = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 128 128 128\nencoding: raw\n\n";
  for (int i = 0; i < 128 * 128 * 128; ++i) volume += static_cast<char>(i / (128 * 128));
  const std::string stream = folder.path("a.qnv");
  REQUIRE(run("encode " + quoted(folder.write("a.nrrd", volume)) + " " + quoted(stream)).status == kDone);
  const Run all = run("info " + quoted(stream)), coarse = run("info --memory 16M " + quoted(stream));
  CHECK(all.output.find("level of values        0") != std::string::npos);
  INFO(coarse.output);
  CHECK(coarse.status == kDone);
  CHECK(coarse.output.find("error:") == std::string::npos);
  CHECK(coarse.output.find("level of values        1") != std::string::npos);
}

TEST_CASE("export, encode: extract the isosurface of a stream of values like that of the volume") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_ball<std::uint8_t>("uint8", 250)),
                    stream = folder.path("a.qnv");
  REQUIRE(run("encode --lossless " + quoted(volume) + " " + quoted(stream)).status == kDone);
  const auto triangles = [&](const std::string& file, const char* out) {
    const Run made = run("export --isovalue 100 " + quoted(file) + " " + quoted(folder.path(out)));
    INFO(made.output);
    REQUIRE(made.status == kDone);
    return folder.read(out).substr(84);  // after the header of STL
  };
  const std::string of_volume = triangles(volume, "a.stl");
  CHECK(of_volume.size() > 10'000);
  CHECK(of_volume == triangles(stream, "b.stl"));
  REQUIRE(run("encode --isovalue 100 " + quoted(stream) + " " + quoted(folder.path("s.qnv"))).status == kDone);
  CHECK(info(folder.path("s.qnv"))["kind"] == "surface");
  REQUIRE(
      run("encode --isovalue 100 --method outlines " + quoted(stream) + " " + quoted(folder.path("o.wrl"))).status ==
      kDone);
  const std::string records = folder.path("r.qnv");
  REQUIRE(run("encode --method records " + quoted(volume) + " " + quoted(records)).status == kDone);
  const Run refused = run("export --isovalue 100 " + quoted(records) + " " + quoted(folder.path("c.stl")));
  CHECK(refused.status == kFailed);
  CHECK(refused.output.find("has no values of voxels; --isovalue expects a volume") != std::string::npos);
}

TEST_CASE("encode: --parity protects a stream, and info reports the restored chunks") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_ball<std::uint16_t>("uint16", 3000)),
                    stream = folder.path("a.qnv");
  REQUIRE(run("encode --parity 30% " + quoted(volume) + " " + quoted(stream)).status == kDone);
  CHECK(info(stream)["restored_chunks"] == 0);
  std::string bytes = folder.read("a.qnv");
  bytes[2000] = static_cast<char>(bytes[2000] ^ 1);
  folder.write("a.qnv", bytes);
  CHECK(info(stream)["restored_chunks"] == 1);
  CHECK(info(stream)["exact"] == true);
  REQUIRE(run("encode --parity 0 " + quoted(volume) + " " + quoted(stream)).status == kDone);
  CHECK_FALSE(info(stream).contains("restored_chunks"));
}

TEST_CASE("export: refuses values of streams that have none") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_ball<std::uint8_t>("uint8", 250)),
                    stream = folder.path("a.qnv");
  REQUIRE(run("encode --method records " + quoted(volume) + " " + quoted(stream)).status == kDone);
  const Run result = run("export " + quoted(stream) + " " + quoted(folder.path("out.nrrd")));
  CHECK(result.status == kFailed);
  CHECK(result.output.find("the input has no values of voxels; expected a volume, or a stream of its values") !=
        std::string::npos);
}

TEST_CASE("snapshot: shows slices of a stream of values like those of the volume") {
  const ScratchFolder folder;
  const std::string volume = folder.write("a.nrrd", nrrd_ball<std::uint8_t>("uint8", 250)),
                    stream = folder.path("a.qnv");
  REQUIRE(run("encode " + quoted(volume) + " " + quoted(stream)).status == kDone);
  const auto picture = [&](const std::string& file, const std::string& name) {
    const std::string out = folder.path(name);
    REQUIRE(run("--snapshot " + quoted(out) + " --size 96x96 --slice z=50% --slices-alone " + quoted(file)).status ==
            kDone);
    return folder.read(name);
  };
  const std::string of_volume = picture(volume, "a.png"), of_stream = picture(stream, "b.png");
  CHECK(of_volume.size() > 500);
  CHECK(of_volume == of_stream);
  // The colours of a prefix are those of the whole range, whatever its own values are.
  const std::string whole = folder.read("a.qnv");
  const std::string part = folder.write("part.qnv", whole.substr(0, whole.size() / 4));
  REQUIRE(
      run("--snapshot " + quoted(folder.path("c.png")) + " --size 96x96 --slice z=50% --slices-alone " + quoted(part))
          .status != kUsage);
  const auto decoded = [&](const std::string& name) {
    const std::string bytes = folder.read(name);
    auto image = render::decode_image(std::as_bytes(std::span(bytes)));
    REQUIRE(std::holds_alternative<render::Image>(image));
    return std::get<render::Image>(std::move(image));
  };
  const render::Image a = decoded("a.png"), c = decoded("c.png");
  REQUIRE(a.pixels.size() == c.pixels.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(int{a.pixels[i]} - int{c.pixels[i]});
  CHECK(sum / static_cast<double>(a.pixels.size()) < 6);
}
