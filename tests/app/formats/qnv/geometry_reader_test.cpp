// Tests of streams that views read in part.
#include "app/formats/qnv/geometry_reader.h"

#include "app/formats/common/color_key.h"
#include "app/formats/qnv/held_streams.h"
#include "app/loading/world_loader.h"
#include "qnv/codecs/gaussians/encode/gaussians_stream.h"
#include "qnv/codecs/gaussians/lod/splat_stream.h"
#include "qnv/codecs/octree/lod/lod.h"
#include "qnv/codecs/shared/encode_options.h"
#include "tests/app/geometry_shapes.h"
#include "tests/app/large_stream.h"
#include "tests/app/scratch_folder.h"
#include "tests/geometries.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

using namespace gs;
using namespace gs::app;

namespace {

qnv::LodStream& levels_of(const LoadedWorld& world) {
  REQUIRE(world.geometries.size() == 1);
  return *content_of<qnv::OctreeSplats>(*world.geometries.begin()->second).stream;
}

std::size_t discs(qnv::LodStream& stream, float error_pixels) {
  qnv::LodView view;
  view.eye = {0, 0, 4};
  view.error_pixels = error_pixels;
  std::size_t sum = 0;
  for (const qnv::Piece& piece : stream.cut(view)) sum += piece.count;
  return sum;
}

}  // namespace

TEST_CASE("reads a large octree stream in place, also if the file becomes shorter") {
  const ScratchFolder folder;
  const std::string file = folder.write("ball.qnv", large_stream());
  const LoadedWorld world = load_world(file);
  CHECK(world.diagnostics.errors() + world.diagnostics.warnings() == 0);
  qnv::LodStream& stream = levels_of(world);
  CHECK(stream.header().vectors > 1'000'000);
  const std::size_t coarse = discs(stream, 50);
  CHECK(coarse > 100);
  std::filesystem::resize_file(file, large_stream().size() / 2);
  const std::size_t half = discs(stream, 0);
  CHECK(half > 10 * coarse);
  CHECK(half < stream.header().vectors);
  CHECK_FALSE(stream.problems().empty());
  // A deleted file stays readable while it is open.
  const std::string other = folder.write("other.qnv", large_stream());
  const LoadedWorld second = load_world(other);
  std::filesystem::remove(other);
  CHECK(discs(levels_of(second), 0) >= stream.header().vectors);  // two-sided voxels give two splats
  CHECK(levels_of(second).problems().empty());
}

TEST_CASE("opens a truncated, thinned or damaged large octree stream with less detail") {
  const ScratchFolder folder;
  const std::string file = folder.write("ball.qnv", large_stream());
  LoadOptions cut;
  cut.max_bytes = large_stream().size() / 2;
  const LoadedWorld half = load_world(file, cut);
  CHECK(half.diagnostics.errors() + half.diagnostics.warnings() == 0);
  LoadOptions lossy;
  lossy.loss = 0.3;
  const LoadedWorld thinned = load_world(file, lossy);
  const std::size_t all = discs(levels_of(load_world(file)), 0);
  CHECK(discs(levels_of(half), 0) < all);
  CHECK(discs(levels_of(half), 0) > all / 4);
  CHECK(discs(levels_of(thinned), 0) < all);
  // A truncated stream has no directory: it is read as a whole, and reported.
  const LoadedWorld early =
      load_world(folder.write("early.qnv", large_stream().substr(0, large_stream().size() * 9 / 10)));
  CHECK(early.diagnostics.errors() == 0);
  CHECK(early.diagnostics.warnings() == 1);
  CHECK(discs(levels_of(early), 0) > all / 2);
  CHECK(discs(levels_of(early), 0) < all);
}

TEST_CASE("copies a stream to memory that cannot be read in place") {
  const auto* first = reinterpret_cast<const std::byte*>(large_stream().data());
  Diagnostics diagnostics;
  CHECK(stream_source("nowhere/at/all.qnv") == nullptr);
  const ScratchFolder folder;
  const std::string other = folder.write("other.qnv", "another file that has come to lie there");
  for (const std::string& path : {std::string("nowhere/at/all.qnv"), other}) {
    const GeometryFile file{path, {first, large_stream().size()}};
    const auto geometry = read_geometry(content_type_of("x.qnv", first_bytes(file.bytes)), file, diagnostics,
                                        std::chrono::steady_clock::now() + std::chrono::hours(1));
    REQUIRE(geometry);
    const auto octree = content_of<qnv::OctreeSplats>(*geometry);
    CHECK(discs(*octree.stream, 0) >= octree.stream->header().vectors);
  }
  CHECK(diagnostics.errors() + diagnostics.warnings() == 0);
}

TEST_CASE("gives the scene of a stream its one colour, and the meaning of its colours") {
  qnv::Splats geometry;
  geometry.color = {51, 102, 204};
  geometry.description.metadata = {{"title", "a part"}, {"color key", "0 10 #000000 #ffffff heat (K)"}};
  vrml::SceneGraph scene("stream.qnv");
  const vrml::NodeId node = add_geometry_shape(scene, geometry, "stream.qnv");
  REQUIRE(node);
  const vrml::NodeId appearance = scene.get<vrml::NodeId>(scene.roots().back(), "appearance");
  const vrml::NodeId material = scene.get<vrml::NodeId>(appearance, "material");
  CHECK(scene.get<vrml::Color>(material, "diffuseColor") == vrml::Color{0.2f, 0.4f, 0.8f});
  const auto key = color_key_of(scene);
  REQUIRE(key);
  CHECK(key->title == "heat (K)");
  CHECK(key->high == 10);
}

TEST_CASE("keeps a stream of Gaussians encoded for views, and decodes all of it for other uses") {
  const auto made = qnv::encode_gaussians(test::random_gaussians(3000, 1), {});
  const auto& bytes = std::get<qnv::EncodedStream>(made).bytes;
  const ScratchFolder folder;
  const std::string path =
      folder.write("cloud.qnv", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  for (const bool whole : {false, true}) {
    LoadOptions options;
    options.whole_surfaces = whole;
    const LoadedWorld world = load_world(path, options);
    CHECK(world.diagnostics.errors() + world.diagnostics.warnings() == 0);
    REQUIRE(world.geometries.size() == 1);
    const auto gaussians = content_of<qnv::Gaussians>(*world.geometries.begin()->second);
    CHECK((gaussians.stream == nullptr) == whole);
    CHECK(gaussians.size() == (whole ? 3000 : 0));
    CHECK_FALSE(gaussians.nothing());
    if (whole) continue;
    CHECK(gaussians.stream->header().vectors == 3000);
    CHECK(gaussians.stream->whole().decode(10'000).size() == 3000);
  }
}

TEST_CASE("received chunks of Gaussians take a part of the memory of the cache") {
  constexpr std::uint64_t kMegabyte = 1 << 20;
  const qnv::SplatLimits usual, local = cut_limits(2048 * kMegabyte, std::nullopt);
  CHECK(local.cache_bytes == usual.cache_bytes);
  CHECK(local.cut_bytes == usual.cut_bytes);
  const qnv::SplatLimits remote = cut_limits(2048 * kMegabyte, 1024 * kMegabyte);
  CHECK(remote.cache_bytes == usual.cache_bytes / 4 * 3);
  CHECK(remote.cut_bytes == usual.cut_bytes);
  CHECK(remote.arrived_bytes == 1025 * kMegabyte);
  const qnv::SplatLimits small = cut_limits(40 * kMegabyte, 2 * kMegabyte);
  CHECK(small.cache_bytes == 18 * kMegabyte);
  CHECK(small.cut_bytes == 20 * kMegabyte);
}
