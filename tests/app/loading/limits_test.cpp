#include "app/formats/content_types.h"
#include "app/formats/qnv/geometry_reader.h"
#include "app/formats/volume/volume.h"
#include "app/loading/world_loader.h"
#include "app/session/documents/documents.h"
#include "base/gzip.h"
#include "render/image/image.h"
#include "tests/app/formats_helpers.h"
#include "tests/app/gzip_bomb.h"
#include "tests/app/scratch_folder.h"
#include "tests/watched.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace gs::limits_test {
// Tests of files that request far more memory than their size. Each has a small memory limit, which scales the others.
namespace {

using namespace app;

constexpr std::size_t kMega = std::size_t{1} << 20;
const std::string kHeader = "#VRML V2.0 utf8\n";
const std::string kBox = "Shape { geometry Box { } }\n";

std::span<const std::byte> bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

std::string packed(const std::string& head, std::size_t zeros, char fill = '\0') {
  return gzip_bomb(head, std::string(4096, fill), zeros);
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

struct Loaded {
  Loaded(const std::string& path, std::size_t memory) {
    LoadOptions options;
    options.limits.memory = memory;
    options.limits.visits /= watched_step(8);
    options.timeout_seconds = 600;  // on a slow machine only the limit should end it
    document = make_document(load_world(path, options));
  }
  [[nodiscard]] std::string said() const {
    std::string text;
    for (const auto& diagnostic : document->world.diagnostics.entries()) text += diagnostic.text() + "\n";
    return text;
  }
  [[nodiscard]] bool said(std::string_view what) const { return said().find(what) != std::string::npos; }
  [[nodiscard]] const render::RenderList& list() const { return *document->list; }
  /// Checks that no resource exceeds its limit.
  void check_budget() const {
    REQUIRE(document->world.scene);
    const Budget& budget = *document->world.scene->budget();
    for (const ResourceRow& row : kResources) {
      INFO(row.name);
      CHECK(budget.used(row.resource) <= budget.limit(row.resource));
    }
  }

  std::shared_ptr<Document> document;
};

template <class T>
void put(std::string& to, std::size_t at, T value) {
  std::memcpy(to.data() + at, &value, sizeof value);
}

/// Returns the header of a NIfTI-1 file of bytes.
std::string nifti(std::int16_t x, std::int16_t y, std::int16_t z) {
  std::string header(352, '\0');
  put<std::int32_t>(header, 0, 348);
  const std::int16_t sizes[] = {3, x, y, z, 1, 1, 1, 1};
  std::memcpy(header.data() + 40, sizes, sizeof sizes);
  put<std::int16_t>(header, 70, 2);
  put<std::int16_t>(header, 72, 8);
  for (int i = 0; i < 8; ++i) put<float>(header, 76 + 4 * static_cast<std::size_t>(i), 1);
  put<float>(header, 108, 352);
  header.replace(344, 4, std::string("n+1\0", 4));
  return header;
}

std::string spz(std::uint32_t splats) {
  std::string header(16, '\0');
  put<std::uint32_t>(header, 0, 0x5053474e);
  put<std::uint32_t>(header, 4, 2);
  put<std::uint32_t>(header, 8, splats);
  header[13] = 12;
  return header;
}

std::string png(std::uint32_t side) {
  render::Image image{side, side, 3, {}};
  image.pixels.assign(std::size_t{side} * side * 3, 90);
  const auto bytes = render::encode_png(image);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

TEST_CASE("stops gzip data that unpack to far more than their size") {
  const auto budget = std::make_shared<Budget>(Limits{.unpack_free = kMega});
  const std::string bomb = packed("", 20 * kMega);
  std::size_t made = 0;
  const auto count = [&](std::string_view piece) {
    made += piece.size();
    return true;
  };
  const auto problem = gunzip(bytes_of(bomb), budget, count);
  REQUIRE(problem);
  CHECK(*problem == "unpacks to more than 250 times its size");
  CHECK(made >= kMega);
  CHECK(made < 2 * kMega + 250 * bomb.size());

  // Data of a lower compression ratio are read up to the limit of the world.
  const auto small = std::make_shared<Budget>(Limits{.memory = 4 * kMega});
  made = 0;
  const auto limit = gunzip(bytes_of(bomb), small, count);
  REQUIRE(limit);
  CHECK(limit->find("more than the limit for unpacked data, 4 MiB") != std::string::npos);
  CHECK(made <= 4 * kMega);
  // The limit applies to all files together.
  CHECK(gunzip(bytes_of(packed("", kMega)), small, count));

  const UnpackedBytes kept =
      unpack_gzip(bytes_of(bomb), std::make_shared<Budget>(Limits{.memory = 16 * kMega}), Resource::files);
  REQUIRE(kept.problem);
  CHECK(kept.problem->find("files in memory, 8 MiB") != std::string::npos);
  CHECK(kept.bytes.size() <= 8 * kMega);
  CHECK(kept.share.amount() == kept.bytes.size());
}

TEST_CASE("shows a compressed world up to the limit of unpacked bytes") {
  const ScratchFolder folder;
  const Loaded blanks(folder.write("blanks.wrz", packed(kHeader + kBox, 10 * kMega, ' ')), 8 * kMega);
  INFO(blanks.said());
  CHECK(blanks.said("blanks.wrz: error: unpacks to more than the limit for unpacked data, 8 MiB"));
  CHECK(blanks.list().items.size() == 1);
  blanks.check_budget();

  const std::string list = kHeader + kBox + "Shape { geometry PointSet { coord Coordinate { point [ ";
  const Loaded numbers(folder.write("numbers.wrz", packed(list, 7 * kMega, '0')), 16 * kMega);
  CHECK(numbers.list().items.size() == 1);
  numbers.check_budget();

  // A world shown by another one shares its budget.
  std::string outer = kHeader;
  for (const char* name : {"a.wrz", "b.wrz", "c.wrz"}) {
    outer += "Inline { url \"" + std::string(name) + "\" }\n";
    folder.write(name, packed(kHeader + kBox, 15 * kMega / 4, ' '));
  }
  const Loaded inlines(folder.write("outer.wrl", outer + kBox), 8 * kMega);
  INFO(inlines.said());
  CHECK(inlines.said("c.wrz: error: unpacks to more than the limit for unpacked data"));
  CHECK(inlines.list().items.size() == 4);  // its box was received earlier
  inlines.check_budget();
}

TEST_CASE("refuses a compressed mesh, volume or splats of zeros by name") {
  const ScratchFolder folder;
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 9000000\nproperty float x\nproperty float y\n"
      "property float z\nelement face 9\nproperty list uchar int vertex_indices\nend_header\n";
  const Loaded mesh(folder.write("zeros.ply.gz", packed(ply, 90 * kMega)), 64 * kMega);
  CHECK(mesh.said("zeros.ply.gz: error: unpacks to more than the limit for files in memory, 32 MiB"));

  const Loaded volume(folder.write("zeros.nii.gz", packed(nifti(512, 512, 400), 100 * kMega)), 64 * kMega);
  INFO(volume.said());
  CHECK(volume.said("zeros.nii.gz: error: unpacks to more than the limit for voxels, 32 MiB"));

  // A volume is refused if a single slice exceeds the limit.
  const Loaded slice(folder.write("slice.nii.gz", packed(nifti(4096, 4096, 1), 16 * kMega)), 128 * kMega);
  INFO(slice.said());
  CHECK(slice.said("slices of 16777216 voxels take more than the limit for voxels, 64 MiB"));

  const Loaded splats(folder.write("zeros.spz", packed(spz(4'000'000), 80'000'000)), 256 * kMega);
  INFO(splats.said());
  CHECK(splats.said("zeros.spz: error: 4000000 splats take more than the limit for vectors, 128 MiB"));
}

TEST_CASE("shows the rest of a world with refused files") {
  const ScratchFolder folder;
  folder.write("zeros.nii.gz", packed(nifti(512, 512, 400), 100 * kMega));
  folder.write("zeros.spz", packed(spz(4'000'000), 80'000'000));
  const Loaded world(folder.write("world.wrl", kHeader + kBox + "Shape { geometry QNV { url \"zeros.nii.gz\" } }\n" +
                                                   "Shape { geometry QNV { url \"zeros.spz\" } }\n" + kBox),
                     64 * kMega);
  INFO(world.said());
  CHECK(world.said("more than the limit for voxels"));
  CHECK(world.said("more than the limit for vectors"));
  CHECK(world.list().items.size() == 2);
  CHECK(world.list().splats.empty());
  world.check_budget();
}

TEST_CASE("shrinks forty textures of one large image, and then leaves them out") {
  const ScratchFolder folder;
  const std::string picture = png(1024);
  std::string world = kHeader;
  for (int i = 0; i < 40; ++i) {
    const std::string name = std::to_string(i) + ".png";
    folder.write(name, picture);
    world += "Shape { appearance Appearance { texture ImageTexture { url \"" + name + "\" } } geometry Box { } }\n";
  }
  const Loaded textures(folder.write("forty.wrl", world), 48 * kMega);
  INFO(textures.said());
  CHECK(textures.list().items.size() == 40);
  CHECK(textures.said("0.png: is shown as "));
  CHECK(textures.said("more than the limit for pixels of textures, 18 MiB"));
  CHECK(textures.said("left out"));
  REQUIRE(textures.list().items[0].texture.image);
  CHECK(textures.list().items[0].texture.image->reduction > 1);
  textures.check_budget();
}

TEST_CASE("shrinks a texture beyond the limit during decoding") {
  const ScratchFolder folder;
  folder.write("large.png", png(1024));
  const std::string path = folder.write(
      "world.wrl",
      kHeader + "Shape { appearance Appearance { texture ImageTexture { url \"large.png\" } } geometry Box { } }\n" +
          "Shape { appearance Appearance { texture ImageTexture { url \"./large.png\" } } geometry Box { } }\n");
  LoadOptions options;
  options.limits.texture_pixels = 256 * 256;
  const LoadedWorld world = load_world(path, options);
  REQUIRE(world.diagnostics.entries().size() == 1);
  CHECK(world.diagnostics.entries()[0].message.find("is shown as 256x256 pixels, 4 times smaller in each direction: "
                                                    "more than the limit for one texture, 65536 pixels") !=
        std::string::npos);
  REQUIRE(world.images.size() == 2);
  CHECK(world.images.begin()->second->width == 256);
  CHECK(world.images.begin()->second == std::next(world.images.begin())->second);  // one image, counted once
  CHECK(world.scene->budget()->used(Resource::pixels) == 256 * 256 * (3 + 6));
}

TEST_CASE("leaves out what USE and PROTO multiply beyond the limit, names the first, and shows the rest") {
  const ScratchFolder folder;
  std::string uses = "DEF N0 Group { children " + kBox + "}\n",
              protos = "PROTO P0 [ ] { Group { children " + kBox + "} }\n";
  for (int i = 1; i <= 25; ++i) {
    const std::string use = "USE N" + std::to_string(i - 1) + " ", proto = "P" + std::to_string(i - 1) + " { } ";
    uses += "DEF N" + std::to_string(i) + " Group { children [ " + use + use + "] }\n";
    protos += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + proto + proto + "] } }\n";
  }
  const Loaded nested(folder.write("use.wrl", kHeader + uses), 64 * kMega);
  INFO(nested.said());
  CHECK(nested.list().items.size() == 8192);
  CHECK(nested.said("use.wrl:2:42: error: more than the limit for shapes in a picture, 8192 of one world"));
  nested.check_budget();

  const Loaded instances(folder.write("proto.wrl", kHeader + protos + "P25 { }\n" + kBox), 64 * kMega);
  INFO(instances.said());
  CHECK(instances.said("proto.wrl:29:1: error: "));
  CHECK(instances.said("more than the limit for PROTO instances"));
  CHECK(instances.list().items.size() == 1);
  instances.check_budget();
}

TEST_CASE("limits an Extrusion of two long lists and grids of one list, and shows the rest") {
  const ScratchFolder folder;
  std::string section, spine;
  for (int i = 0; i < 3000; ++i) {
    section += std::to_string(i % 9) + " " + std::to_string(i % 7) + ",";
    spine += "0 " + std::to_string(i) + " 0,";
  }
  const Loaded extrusion(folder.write("extrusion.wrl", kHeader + kBox +
                                                           "Shape { geometry Extrusion { creaseAngle 1 "
                                                           "crossSection [ " +
                                                           section + " ] spine [ " + spine + " ] } }\n" + kBox),
                         64 * kMega);
  INFO(extrusion.said());
  CHECK(extrusion.said("extrusion.wrl:3:18: error: more than the limit for meshes, 32 MiB"));
  CHECK(extrusion.list().items.size() == 3);  // with its start cap
  extrusion.check_budget();

  const std::string grid = "PROTO G [ ] { Shape { geometry ElevationGrid { xDimension 100 zDimension 100 height [ " +
                           repeated("0 ", 10'000) + "] } } }\n";
  const Loaded grids(folder.write("grids.wrl", kHeader + grid + repeated("G { }\n", 100) + kBox), 64 * kMega);
  INFO(grids.said());
  CHECK(grids.said("more than the limit for meshes, 32 MiB"));
  CHECK(grids.list().items.size() > 10);
  CHECK(grids.list().items.size() < 90);
  grids.check_budget();
}

TEST_CASE("ends nested Inlines in data URLs") {
  const ScratchFolder folder;
  std::string inner = kHeader + kBox;
  for (int i = 0; i < 12; ++i) {
    std::string escaped;
    for (const char c : inner) escaped += c == '"' ? "%22" : c == '#' ? "%23" : c == '%' ? "%25" : std::string(1, c);
    inner = kHeader + kBox + "Inline { url \"data:model/vrml," + escaped + "\" }";
    if (inner.size() > kMega) break;
  }
  LoadOptions options;
  options.limits.inline_depth = 4;
  const LoadedWorld world = load_world(folder.write("nested.wrl", inner), options);
  REQUIRE(world.scene);
  std::string said;
  for (const auto& diagnostic : world.diagnostics.entries()) said += diagnostic.text() + "\n";
  CHECK(said.find("refers back to") != std::string::npos);
}

TEST_CASE("stops a world of too many files, and names the limit") {
  const ScratchFolder folder;
  std::string text = kHeader + kBox;
  for (int i = 0; i < 50; ++i) text += "Inline { url \"" + std::to_string(i) + ".wrl\" }\n";
  LoadOptions options;
  options.limits.files = 20;
  const LoadedWorld world = load_world(folder.write("many.wrl", text), options);
  REQUIRE(world.scene);
  std::string said;
  for (const auto& diagnostic : world.diagnostics.entries()) said += diagnostic.text() + "\n";
  CHECK(said.find("refers to more than 20 files") != std::string::npos);
}

TEST_CASE("charges importers of splats and points to the given budget") {
  const auto budget = std::make_shared<Budget>(Limits{.memory = kMega});
  const auto refused = [&](std::string_view name, const std::string& text) {
    for (const ContentType& type : content_types()) {
      if (type.name != name) continue;
      Diagnostics diagnostics;
      CHECK(std::holds_alternative<std::monostate>(type.read({bytes_of(text), "x", {}, budget, diagnostics})));
      CHECK(budget->used(Resource::vectors) == 0);
      const auto& problems = diagnostics.entries();
      return !problems.empty() && problems[0].message.find("more than the limit for vectors") != std::string::npos;
    }
    return false;
  };
  const std::string vertex = "\nproperty float x\nproperty float y\nproperty float z\n";
  CHECK(refused("splats", std::string(32 * 10'000, '\1')));
  CHECK(refused("points", repeated("0 0 0 0 0 1\n", 10'000)));
  CHECK(refused("points PLY", "ply\nformat binary_little_endian 1.0\nelement vertex 10000" + vertex +
                                  "property float nx\nproperty float ny\nproperty float nz\nend_header\n" +
                                  std::string(24 * 10'000, '\1')));
  std::string splats = "ply\nformat binary_little_endian 1.0\nelement vertex 10000" + vertex;
  for (const char* name : {"opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"})
    splats += "property float " + std::string(name) + "\n";
  CHECK(refused("splats PLY", splats + "end_header\n" + std::string(44 * 10'000, '\1')));
  CHECK(refused("SPZ splats", packed(spz(10'000), 200'000)));
}

TEST_CASE("cancels a load inside a gzip member and inside an image") {
  const ScratchFolder folder;
  std::atomic<bool> cancelled = true;
  LoadOptions options;
  options.cancelled = &cancelled;
  const LoadedWorld world = load_world(folder.write("blanks.wrz", packed(kHeader + kBox, 50 * kMega, ' ')), options);
  CHECK(world.truncated);
  const auto budget = world.scene ? world.scene->budget() : own_budget();
  CHECK(budget->used(Resource::unpacked) < kMega);
}

}  // namespace gs::limits_test
