#include "app/formats/content_types.h"
#include "app/formats/splats/splats_sog.h"
#include "tests/app/commands/vector_commands.h"
#include "tests/app/geometry_shapes.h"

#include <webp/encode.h>
#include <zlib.h>
#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace gs::app::formats_sog_test {
namespace {

using namespace gs::test;
using Files = std::map<std::string, Bytes>;

/// Returns a WebP image without losses, one row of RGBA pixels.
Bytes webp(const std::vector<std::uint8_t>& rgba, int width, int height = 1) {
  std::uint8_t* coded = nullptr;
  WebPConfig config;
  WebPPicture picture;
  REQUIRE(WebPConfigInit(&config) != 0);
  REQUIRE(WebPPictureInit(&picture) != 0);
  config.lossless = 1;
  config.exact = 1;  // keeps the colours of transparent pixels
  picture.use_argb = 1;
  picture.width = width;
  picture.height = height;
  REQUIRE(WebPPictureImportRGBA(&picture, rgba.data(), 4 * width) != 0);
  WebPMemoryWriter writer;
  WebPMemoryWriterInit(&writer);
  picture.writer = WebPMemoryWrite;
  picture.custom_ptr = &writer;
  REQUIRE(WebPEncode(&config, &picture) != 0);
  WebPPictureFree(&picture);
  coded = writer.mem;
  const Bytes bytes(reinterpret_cast<std::byte*>(coded), reinterpret_cast<std::byte*>(coded) + writer.size);
  WebPMemoryWriterClear(&writer);
  return bytes;
}

std::string codebook(float first, float step) {
  std::string text = "[";
  for (int i = 0; i < 256; ++i) text += (i > 0 ? "," : "") + std::to_string(first + step * static_cast<float>(i));
  return text + "]";
}

/// Files of a SOG of version 2 with two splats.
Files two_splats() {
  Files files;
  files["means_l.webp"] = webp({0, 0, 0, 255, 0xff, 0xff, 0xff, 255}, 2);
  files["means_u.webp"] = webp({0, 0, 0, 255, 0xff, 0xff, 0x7f, 255}, 2);
  files["scales.webp"] = webp({100, 110, 120, 255, 0, 10, 20, 255}, 2);
  files["quats.webp"] = webp({128, 128, 128, 252, 128, 128, 255, 255}, 2);
  files["sh0.webp"] = webp({128, 138, 148, 51, 0, 128, 255, 204}, 2);
  std::vector<std::uint8_t> palette(static_cast<std::size_t>(4) * 192, 255);
  for (std::size_t i = 0; i < 9; ++i)
    palette[4 * (i / 3 + 3) + i % 3] = static_cast<std::uint8_t>(10 * i);  // of label 1
  files["shN_centroids.webp"] = webp(palette, 192);
  files["shN_labels.webp"] = webp({1, 0, 0, 255, 1, 0, 0, 255}, 2);
  const std::string meta =
      "{\"version\":2,\"count\":2,\"antialias\":true,"
      "\"means\":{\"mins\":[-1,-1,-1],\"maxs\":[1,1,1],\"files\":[\"means_l.webp\",\"means_u.webp\"]},"
      "\"scales\":{\"codebook\":" +
      codebook(-12, 0.05f) +
      ",\"files\":[\"scales.webp\"]},"
      "\"quats\":{\"files\":[\"quats.webp\"]},"
      "\"sh0\":{\"codebook\":" +
      codebook(-1.28f, 0.01f) +
      ",\"files\":[\"sh0.webp\"]},"
      "\"shN\":{\"count\":64,\"bands\":1,\"codebook\":" +
      codebook(-1, 0.01f) + ",\"files\":[\"shN_centroids.webp\",\"shN_labels.webp\"]}}";
  files["meta.json"] = bytes_of(meta);
  return files;
}

void put16(Bytes& to, std::size_t value) {
  to.push_back(static_cast<std::byte>(value & 255));
  to.push_back(static_cast<std::byte>(value >> 8 & 255));
}
void put32(Bytes& to, std::size_t value) {
  put16(to, value & 0xffff);
  put16(to, value >> 16);
}
void put_name(Bytes& to, const std::string& name) {
  for (const char c : name) to.push_back(static_cast<std::byte>(c));
}

/// Returns a ZIP archive of uncompressed files in a folder. The files of `last` come last.
Bytes zipped(const Files& files, const std::string& folder = "", const Files& last = {}) {
  Bytes archive, directory;
  std::vector<std::pair<std::string, Bytes>> all(files.begin(), files.end());
  all.insert(all.end(), last.begin(), last.end());
  for (const auto& [name, bytes] : all) {
    const std::size_t offset = archive.size();
    const std::size_t sum = crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size()));
    const auto put_facts = [&](Bytes& to) {
      for (const std::size_t field : {std::size_t{10}, std::size_t{0}, std::size_t{0}, std::size_t{0}, std::size_t{0}})
        put16(to, field);
      put32(to, sum);
      put32(to, bytes.size());
      put32(to, bytes.size());
      put16(to, folder.size() + name.size());
      put16(to, 0);
    };
    put32(archive, 0x04034b50);
    put_facts(archive);
    put_name(archive, folder + name);
    archive.insert(archive.end(), bytes.begin(), bytes.end());
    put32(directory, 0x02014b50);
    put16(directory, 10);
    put_facts(directory);
    for (int i = 0; i < 3; ++i) put16(directory, 0);
    put32(directory, 0);
    put32(directory, offset);
    put_name(directory, folder + name);
  }
  const std::size_t start = archive.size();
  archive.insert(archive.end(), directory.begin(), directory.end());
  put32(archive, 0x06054b50);
  put32(archive, 0);
  put16(archive, all.size());
  put16(archive, all.size());
  put32(archive, directory.size());
  put32(archive, start);
  put16(archive, 0);
  return archive;
}

/// Imports bytes as SOG. `beside` has the files beside them.
std::variant<qnv::Gaussians, std::string> imported(const Bytes& bytes, const Files& beside = {}) {
  Diagnostics diagnostics;
  const ReadFile read = [&](const std::string& reference) -> BytesResult {
    const auto found = beside.find(reference);
    if (found == beside.end()) return reference + " is missing";
    return shared_bytes(std::vector<std::byte>(found->second.begin(), found->second.end()));
  };
  Asset asset = read_splats_sog({bytes, "test.sog", read, own_budget(), diagnostics});
  if (auto* gaussians = std::get_if<qnv::Gaussians>(&asset)) return std::move(*gaussians);
  REQUIRE(diagnostics.errors() == 1);
  return diagnostics.entries()[0].message;
}

void check_two(const qnv::Gaussians& read) {
  REQUIRE(read.size() == 2);
  CHECK(read.antialiased);
  const float far = static_cast<float>(std::expm1(1));
  const glm::vec3 first = glm::vec3(read.description.origin) + read.positions[0];
  CHECK(first.x == Approx(-far));
  CHECK(first.y == Approx(far));  // down in the file
  CHECK((glm::vec3(read.description.origin) + read.positions[1]).x == Approx(far));
  CHECK(read.positions[1].z == Approx(0).margin(0.001));
  CHECK(read.scales[0].x == Approx(std::exp(-7.0f)));
  CHECK(read.scales[1].z == Approx(std::exp(-11.0f)));
  CHECK(std::abs(read.rotations[0].w) == Approx(1).margin(0.001));  // w was left out
  CHECK(read.opacities[0] == Approx(0.2f));
  CHECK(read.opacities[1] == Approx(0.8f));
  CHECK(read.bases[0].y == Approx(0.5f + 0.28209479f * 0.1f).margin(1e-4));
  REQUIRE(read.degree == 1);
  // The coefficients of y and z change their signs with the axes.
  CHECK(read.harmonics[0].x == Approx(1));
  CHECK(read.harmonics[1].z == Approx(-(50 * 0.01 - 1)));
  CHECK(read.harmonics[2].y == Approx(70 * 0.01 - 1));
}

/// lod-meta.json with two parts of one splat each, in two levels.
const std::string kTwoLevels =
    "{\"version\":1,\"lodLevels\":2,\"filenames\":[\"0_0/meta.json\",\"1_0/meta.json\"],\"environment\":null,\"tree\":"
    "{\"bound\":{\"min\":[0,0,0],\"max\":[1,1,1]},\"children\":["
    "{\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":1},\"1\":{\"file\":1,\"offset\":1,\"count\":1}}},"
    "{\"lods\":{\"0\":{\"file\":0,\"offset\":1,\"count\":1}}}]}}";

/// Files of a streamed SOG with two levels.
Files two_levels(const std::string& meta = kTwoLevels) {
  Files files;
  for (const auto& [name, bytes] : two_splats())
    for (const char* folder : {"0_0/", "1_0/"}) files[folder + name] = bytes;
  files["lod-meta.json"] = bytes_of(meta);
  return files;
}

/// Result of reading streamed SOG.
struct ReadLevels {
  Asset asset;
  Diagnostics diagnostics;
};
ReadLevels read_levels(const Bytes& bytes, const Files& beside = {}, const WorldBudget& budget = own_budget()) {
  ReadLevels result;
  const ReadFile read = [&](const std::string& reference) -> BytesResult {
    const auto found = beside.find(reference);
    if (found == beside.end()) return reference + " is missing";
    return shared_bytes(std::vector<std::byte>(found->second.begin(), found->second.end()));
  };
  result.asset = read_splats_sog_levels({bytes, "lod-meta.json", read, budget, result.diagnostics});
  return result;
}

}  // namespace

TEST_CASE("reads SOG from a folder and from archives") {
  const Files files = two_splats();
  const Bytes& meta = files.at("meta.json");
  CHECK(is_splats_sog(meta));
  CHECK(content_type_of("x", meta).name == "SOG");
  const auto beside = imported(meta, files);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(beside));
  check_two(std::get<qnv::Gaussians>(beside));
  for (const char* folder : {"", "scene/"}) {
    const Bytes archive = zipped(files, folder);
    CHECK(is_splats_sog(archive));
    const auto read = imported(archive);
    INFO((std::holds_alternative<std::string>(read) ? std::get<std::string>(read) : ""));
    REQUIRE(std::holds_alternative<qnv::Gaussians>(read));
    check_two(std::get<qnv::Gaussians>(read));
  }
}

TEST_CASE("info, export and encode read the images beside meta.json of a SOG") {
  const ScratchFolder folder;
  for (const auto& [name, bytes] : two_splats())
    folder.write(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const std::string meta = folder.path("meta.json"), ply = folder.path("two.3dgs.ply");
  CHECK(info(meta)["vectors"] == 2);
  CHECK(file_of_folder(folder.path("")) == meta);
  CHECK(info(folder.path(""))["vectors"] == 2);
  const Run exported = run("export " + quoted(meta) + " " + quoted(ply));
  CHECK(exported.status == kDone);
  CHECK(exported.output.find("note") == std::string::npos);
  CHECK(folder.read("two.3dgs.ply").find("property float f_rest_8") != std::string::npos);
  const Run encoded = run("encode --method records " + quoted(meta) + " " + quoted(folder.path("two.qnv")) + " 2>&1");
  CHECK(encoded.status == kDone);
  CHECK(encoded.output.find("note: splats become opaque surface splats, without their opacity and spherical harmonics "
                            "up to degree 1") != std::string::npos);
}

TEST_CASE("reports what is missing or damaged in a SOG") {
  const auto problem_with = [](const std::string& name, const Bytes& bytes) {
    Files files = two_splats();
    if (bytes.empty())
      files.erase(name);
    else
      files[name] = bytes;
    const auto read = imported(files.contains("meta.json") ? files["meta.json"] : Bytes(), files);
    return std::holds_alternative<std::string>(read) ? std::get<std::string>(read) : std::string();
  };
  CHECK(problem_with("quats.webp", {}).find("quats.webp is missing") != std::string::npos);
  CHECK(problem_with("quats.webp", bytes_of("RIFF")).find("quats.webp is not a WebP image") != std::string::npos);
  CHECK(problem_with("sh0.webp", webp({0, 0, 0, 255}, 1)).find("expected one for each of 2 splats") !=
        std::string::npos);
  CHECK(problem_with("shN_centroids.webp", webp(std::vector<std::uint8_t>(400, 9), 100)).find("100 pixels wide") !=
        std::string::npos);
  CHECK(problem_with("meta.json", bytes_of("[1]")).find("not a JSON object") != std::string::npos);
  CHECK(problem_with("meta.json", bytes_of("{\"version\":3,\"means\":{}}")).find("SOG version 3; expected 1 or 2") !=
        std::string::npos);
  CHECK(problem_with("meta.json", bytes_of("{\"version\":2,\"count\":-1}")).find("number of splats") !=
        std::string::npos);
  std::string meta;
  const Files whole = two_splats();
  for (const std::byte b : whole.at("meta.json")) meta += static_cast<char>(b);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = meta;
    text.replace(text.find(from), from.size(), to);
    return problem_with("meta.json", bytes_of(text));
  };
  CHECK(changed("\"scales.webp\"", "\"../scales.webp\"").find("another folder") != std::string::npos);
  CHECK(changed("\"mins\":[-1,", "\"mins\":[null,").find("range of the positions") != std::string::npos);
  CHECK(changed("\"count\":2", "\"count\":3").find("expected one for each of 3") != std::string::npos);
  CHECK(changed("\"codebook\":[", "\"codebook\":[[],").find("scales") != std::string::npos);
}

TEST_CASE("reads damaged SOG archives without faults") {
  const Bytes archive = zipped(two_splats());
  for (std::size_t length = 0; length < archive.size(); length += 7)
    (void)imported(Bytes(archive.begin(), archive.begin() + static_cast<std::ptrdiff_t>(length)));
  Bytes damaged = archive;
  for (std::size_t i = 0; i < archive.size(); i += 5) {
    damaged[i] ^= std::byte{0x55};
    (void)imported(damaged);
    damaged[i] = archive[i];
  }
}

TEST_CASE("reads SOG of both versions that other programs wrote") {
  for (const auto& [path, count, degree] :
       {std::tuple{"data/splats/playcanvas-logo/meta.json", std::size_t{307128}, 0},
        std::tuple{"data/splats-formats/playbot/3_0/meta.json", std::size_t{31000}, 2}}) {
    const auto file = shared_folder() / path;
    if (!std::filesystem::exists(file)) {
      WARN("no " << file);
      continue;
    }
    Files files;
    for (const auto& entry : std::filesystem::directory_iterator(file.parent_path()))
      files[entry.path().filename().string()] = file_bytes(entry.path());
    const auto read = imported(files["meta.json"], files);
    REQUIRE(std::holds_alternative<qnv::Gaussians>(read));
    const auto& gaussians = std::get<qnv::Gaussians>(read);
    INFO(path << " has " << gaussians.size());
    CHECK(gaussians.size() <= count);
    CHECK(gaussians.size() > count * 9 / 10);
    CHECK(gaussians.degree == degree);
  }
}

TEST_CASE("reads the finest level of streamed SOG from a folder and from an archive") {
  const Files files = two_levels();
  const Bytes& meta = files.at("lod-meta.json");
  CHECK(content_type_of("x", meta).name == "streamed SOG");
  const ReadLevels beside = read_levels(meta, files);
  CHECK(beside.diagnostics.entries().empty());
  REQUIRE(std::holds_alternative<qnv::Gaussians>(beside.asset));
  check_two(std::get<qnv::Gaussians>(beside.asset));
  // The list is the first file of an archive.
  Files last = files;
  last.erase("lod-meta.json");
  const Bytes archive = zipped({{"lod-meta.json", meta}}, "", last);
  CHECK(content_type_of("x", archive).name == "streamed SOG");
  const ReadLevels packed = read_levels(archive);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(packed.asset));
  check_two(std::get<qnv::Gaussians>(packed.asset));
}

TEST_CASE("takes another level of streamed SOG if a file is missing") {
  Files files = two_levels();
  files.erase("0_0/sh0.webp");
  const ReadLevels coarse = read_levels(files.at("lod-meta.json"), files);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(coarse.asset));
  CHECK(std::get<qnv::Gaussians>(coarse.asset).size() == 1);  // the other part has no other level
  REQUIRE(coarse.diagnostics.entries().size() == 1);
  CHECK(coarse.diagnostics.entries()[0].message.find("0_0/sh0.webp is missing; another level replaces it") !=
        std::string::npos);
  files.erase("1_0/meta.json");
  const ReadLevels none = read_levels(files.at("lod-meta.json"), files);
  CHECK(std::holds_alternative<std::monostate>(none.asset));
  CHECK(none.diagnostics.errors() == 1);
}

TEST_CASE("reads streamed SOG without its environment if that is missing") {
  std::string meta = kTwoLevels;
  meta.replace(meta.find("null"), 4, "\"env/meta.json\"");
  const Files files = two_levels(meta);
  const ReadLevels read = read_levels(files.at("lod-meta.json"), files);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(read.asset));
  CHECK(std::get<qnv::Gaussians>(read.asset).size() == 2);
  REQUIRE(read.diagnostics.entries().size() == 1);
  CHECK(read.diagnostics.entries()[0].message == "env/meta.json is missing; the environment is left out");
}

TEST_CASE("keeps the fine levels of other parts of streamed SOG if a file is missing and memory is short") {
  const Files files = two_levels(
      "{\"version\":1,\"lodLevels\":2,\"filenames\":[\"0_0/meta.json\",\"1_0/meta.json\",\"2_0/meta.json\"],\"tree\":"
      "{\"children\":["
      "{\"lods\":{\"0\":{\"file\":0,\"offset\":0,\"count\":1},\"1\":{\"file\":1,\"offset\":1,\"count\":1}}},"
      "{\"lods\":{\"0\":{\"file\":2,\"offset\":0,\"count\":1},\"1\":{\"file\":1,\"offset\":1,\"count\":1}}}]}}");
  const auto budget = std::make_shared<Budget>();
  Share others(budget, Resource::vectors);
  REQUIRE(others.grow(budget->left(Resource::vectors) - 2300));  // enough for two splats
  const ReadLevels read = read_levels(files.at("lod-meta.json"), files, budget);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(read.asset));
  const auto& splats = std::get<qnv::Gaussians>(read.asset);
  REQUIRE(splats.size() == 2);
  CHECK(splats.opacities[0] == Approx(0.2f));
  CHECK(splats.opacities[1] == Approx(0.8f));
}

TEST_CASE("reports what is damaged in the list of streamed SOG") {
  const auto problem_with = [](const std::string& from, const std::string& to) {
    std::string text = kTwoLevels;
    text.replace(text.find(from), from.size(), to);
    const Files files = two_levels(text);
    const ReadLevels read = read_levels(files.at("lod-meta.json"), files);
    return read.diagnostics.entries().empty() ? std::string() : read.diagnostics.entries()[0].message;
  };
  CHECK(problem_with("\"version\":1", "\"version\":2").find("version is not supported") != std::string::npos);
  CHECK(problem_with("\"0_0/meta.json\"", "\"../meta.json\"").find("outside of its folder") != std::string::npos);
  CHECK(problem_with("\"0_0/meta.json\"", "\"https://a/meta.json\"").find("outside of its folder") !=
        std::string::npos);
  CHECK(problem_with("\"file\":0", "\"file\":7").find("no valid file, offset and count") != std::string::npos);
  CHECK(problem_with("\"file\":0,\"offset\":1", "\"file\":0,\"offset\":2").find("has 2 splats; expected 3") !=
        std::string::npos);
  CHECK(problem_with("\"tree\"", "\"trees\"").find("has no tree") != std::string::npos);
  CHECK(problem_with("\"count\":1", "\"count\":-1").find("no valid file") != std::string::npos);
  CHECK(problem_with("\"lods\":{\"0\"", "\"lods\":{\"x\"").find("expected a number") != std::string::npos);
  const Files files = two_levels();
  for (std::size_t length = 0; length < kTwoLevels.size(); length += 3)
    (void)read_levels(bytes_of(kTwoLevels.substr(0, length)), files);
}

TEST_CASE("reads streamed SOG of another program, without its finest levels") {
  const auto folder = shared_folder() / "data/splats-formats/playbot";
  if (!std::filesystem::exists(folder / "lod-meta.json")) {
    WARN("no " << folder);
    return;
  }
  Files files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      files[std::filesystem::relative(entry.path(), folder).generic_string()] = file_bytes(entry.path());
  const ReadLevels read = read_levels(files.at("lod-meta.json"), files);
  REQUIRE(std::holds_alternative<qnv::Gaussians>(read.asset));
  const auto& gaussians = std::get<qnv::Gaussians>(read.asset);
  INFO(gaussians.size());
  CHECK(gaussians.size() > 27900);  // level 3
  CHECK(gaussians.size() <= 31000);
  CHECK(read.diagnostics.entries().size() == 3);  // levels 0, 1 and 2 are missing
}

}  // namespace gs::app::formats_sog_test
