// Tests of volumes that are larger than memory, as cells over UDP on this machine.
#include "app/commands/common/streamed_parts.h"
#include "app/streams/cell_wishes.h"
#include "qnv/codecs/shared/volume_detail.h"
#include "qnv/codecs/values/bricks/brick_volume.h"
#include "qnv/codecs/values/encode/values_stream.h"
#include "qnv/reader/directory_requests.h"
#include "tests/app/loading/fetch/cell_site.h"
#include "tests/geometries.h"
#include "tests/qnv/volume_sources.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include <random>

using namespace gs;
using namespace gs::app;

namespace {

// Noise in steps, more than a megabyte.
const std::string& noisy_volume() {
  static const std::string bytes = [] {
    qnv::VolumeLayout layout;
    layout.dimensions = {160, 160, 128};
    layout.type = qnv::VoxelType::u16;
    std::mt19937 random(7);
    std::vector<std::uint16_t> voxels;
    for (std::uint32_t z = 0; z < 128; ++z)
      for (std::uint32_t y = 0; y < 160; ++y)
        for (std::uint32_t x = 0; x < 160; ++x)
          voxels.push_back(static_cast<std::uint16_t>(1000 * ((x / 19 + y / 17 + z / 23) % 3) + random() % 200));
    const auto encoded = qnv::encode_values(test::volume_of(layout, voxels), {});
    REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
    return string_of(std::get<qnv::EncodedStream>(encoded).bytes);
  }();
  return bytes;
}

LoadOptions small_memory() {
  LoadOptions options;
  options.timeout_seconds = 60;
  options.limits.memory = std::size_t{16} << 20;
  options.large_by_view = true;
  return options;
}

qnv::LodView view_of_corner() {
  qnv::LodView view;
  view.eye = glm::vec3(30, 30, -40);
  view.pixels = 1e6f;
  view.planes[0] = {-1, 0, 0, 60};
  view.planes[1] = {0, -1, 0, 60};
  return view;
}

std::shared_ptr<const qnv::Volume> shown_of(const LoadedWorld& world, const qnv::LodView& view) {
  REQUIRE(world.geometries.size() == 1);
  const auto& volume = content_of<qnv::Volume>(*world.geometries.begin()->second);
  REQUIRE(volume.detail);
  bool pending = false;
  auto shown = volume.detail->cut(view, pending);
  CHECK_FALSE(pending);
  return shown;
}

}  // namespace

TEST_CASE("cells: A view of a large volume receives what it shows, also after losses") {
  CellSite site;
  site.folder.write("values.qnv", noisy_volume());
  site.start();
  REQUIRE(noisy_volume().size() > (std::size_t{1} << 20));
  const auto expected = shown_of(load_world(site.folder.path("values.qnv"), small_memory()), view_of_corner());
  for (const double loss : {0.0, 0.3}) {
    INFO("loss " << loss);
    LoadOptions options = small_memory();
    options.loss = loss;
    WorldLoading loading(site.url("values.qnv"), options);
    const LoadedWorld world = load_world(loading, site.url("values.qnv"));
    REQUIRE(world.feeds.size() == 1);
    CHECK(loading.streaming());
    int draws = 0;
    receive_for_picture(loading, world, 60, [&] {
      (void)shown_of(world, view_of_corner());
      ++draws;
    });
    const auto shown = shown_of(world, view_of_corner());
    CHECK(draws > 1);
    CHECK(draws < 20);
    CHECK(shown->positions == expected->positions);
    CHECK(shown->weights == expected->weights);
    CHECK(loading.state().received < noisy_volume().size() * 4 / 5);
  }
}

TEST_CASE("cells: Names of chunks have a number each, in several streams") {
  for (const std::size_t number : {std::size_t{0}, net::kMaxChunks - 1, net::kMaxChunks, 3 * net::kMaxChunks + 5}) {
    const net::ChunkName name = cell_of_number(number);
    CHECK(name.stream != kPlacesStream);
    CHECK(number_of_cell(name) == number);
    const auto streams = cells_of_numbers(number + 1, 9);
    REQUIRE(name.stream < streams.size());
    CHECK(streams[name.stream] == name.chunk + 1);
    CHECK(streams[kPlacesStream] == 9);
  }
}

namespace {

/// Stream of the noisy volume with its directory, and its chunks after the base.
struct CutStream {
  std::vector<std::byte> base;
  std::vector<std::pair<std::uint64_t, std::vector<std::byte>>> chunks;
  std::vector<std::vector<std::byte>> places;
  std::shared_ptr<qnv::BrickVolume> volume;

  CutStream() {
    const auto bytes = std::as_bytes(std::span(noisy_volume()));
    std::size_t header_bytes = 0;
    bool need_more = false;
    const auto decoded = qnv::decode_header(bytes, header_bytes, need_more);
    REQUIRE(std::holds_alternative<qnv::StreamHeader>(decoded));
    for (std::size_t at = header_bytes; at < bytes.size();) {
      const auto head = qnv::chunk_head(bytes.subspan(at));
      REQUIRE(head);
      std::vector<std::byte> chunk(bytes.begin() + static_cast<std::ptrdiff_t>(at),
                                   bytes.begin() + static_cast<std::ptrdiff_t>(at + head->bytes));
      if (head->type == qnv::ChunkType::places)
        places.push_back(std::move(chunk));
      else if (head->type == qnv::ChunkType::values || head->type == qnv::ChunkType::remainders)
        chunks.emplace_back(at, std::move(chunk));
      at += head->bytes;
    }
    const std::size_t front = static_cast<std::size_t>(chunks[3].first);
    base.assign(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(front));
    chunks.erase(chunks.begin(), chunks.begin() + 3);
    qnv::BrickLimits limits;
    limits.base_vectors = 8192;
    auto begun = qnv::BrickVolume::begin(base, limits);
    REQUIRE(std::holds_alternative<std::shared_ptr<qnv::BrickVolume>>(begun));
    volume = std::get<0>(begun);
  }
};

}  // namespace

TEST_CASE("cells: Wishes name the directory and the first chunks, then what views want") {
  CutStream cut;
  const auto feed = std::make_shared<StreamFeed>(cut.volume, [] {});
  CellWishes wishes(feed, cut.base, static_cast<std::uint32_t>(cut.places.size()));
  REQUIRE(wishes.update());
  CHECK_FALSE(wishes.rests());
  REQUIRE(wishes.names().size() == 33 * cut.places.size());
  CHECK(wishes.names()[0] == net::ChunkName{kPlacesStream, 0});
  CHECK(wishes.names()[1] == net::ChunkName{0, 0});
  // Early chunks wait for their offsets.
  CHECK(wishes.take({0, 0}, cut.chunks[0].second).empty());
  CHECK_FALSE(feed->apply());
  for (std::size_t i = 0; i < cut.places.size(); ++i)
    CHECK(wishes.take({kPlacesStream, static_cast<std::uint32_t>(i)}, cut.places[i]).empty());
  CHECK(feed->apply());
  bool pending = false;
  (void)cut.volume->cut(view_of_corner(), pending);
  feed->ask();
  REQUIRE(wishes.update());
  REQUIRE_FALSE(wishes.names().empty());
  CHECK(std::ranges::find(wishes.names(), net::ChunkName{0, 0}) == wishes.names().end());
  // Each name is a wanted chunk.
  const auto wanted = cut.volume->wanted();
  REQUIRE(wishes.names().size() == wanted.size());
  for (std::size_t i = 0; i < wanted.size(); ++i)
    CHECK(cut.chunks[number_of_cell(wishes.names()[i])].first == wanted[i].offset);
  for (const net::ChunkName& name : std::vector(wishes.names()))
    CHECK(wishes.take(name, cut.chunks[number_of_cell(name)].second).empty());
  CHECK(wishes.rests());
  CHECK(wishes.take_again().empty());
}

TEST_CASE("cells: A directory that is damaged ends the wishes with an error") {
  CutStream cut;
  CellWishes wishes(std::make_shared<StreamFeed>(cut.volume, [] {}), cut.base,
                    static_cast<std::uint32_t>(cut.places.size()));
  std::vector<std::byte> damaged = cut.places[0];
  damaged.back() ^= std::byte{1};
  CHECK(wishes.take({kPlacesStream, 0}, damaged) == "its directory is invalid");
  // Numbers beyond all chunks are ignored.
  CHECK(wishes.take({15, 0xfffff}, cut.chunks[0].second).empty());
  CHECK_FALSE(wishes.take({kPlacesStream, 0xfffff}, cut.places[0]).empty());
}

TEST_CASE("cells: Wishes of a time series name the chunks of the shown step first, and end with the last one") {
  qnv::VolumeSource source;
  std::mt19937 random(3);
  for (int step = 0; step < 10; ++step) {
    source.steps.push_back(
        test::volume_of(test::oblique(20, 16, 12), [&](std::uint32_t x, std::uint32_t y, std::uint32_t z) {
          return static_cast<float>(x + y * z) + static_cast<float>(random() % 100);
        }));
    source.times.push_back(step);
  }
  source.layout = source.steps[0].layout;
  source.read = source.steps[0].read;
  const auto encoded = qnv::encode_values(source, {});
  REQUIRE(std::holds_alternative<qnv::EncodedStream>(encoded));
  const auto& stream = std::get<qnv::EncodedStream>(encoded);
  qnv::StreamHeader header = stream.header;
  header.directory = std::uint64_t{9} << 20;  // of a long stream
  const std::vector<std::byte> base = qnv::encode_header(header);
  std::vector<std::vector<std::byte>> chunks, places;
  const auto rest = std::span(stream.bytes).subspan(base.size());
  for (std::size_t at = 0; at < rest.size();) {
    const auto head = qnv::chunk_head(rest.subspan(at));
    REQUIRE(head);
    const auto chunk = rest.subspan(at, head->bytes);
    if (head->type == qnv::ChunkType::places)
      places.emplace_back(chunk.begin(), chunk.end());
    else if (head->type != qnv::ChunkType::parity)
      chunks.emplace_back(chunk.begin(), chunk.end());
    at += head->bytes;
  }
  REQUIRE_FALSE(places.empty());
  const auto requests = std::make_shared<qnv::DirectoryRequests>(header);
  const auto feed = std::make_shared<StreamFeed>(requests, [] {});
  REQUIRE(CellWishes::suits(*feed, base));
  CHECK_FALSE(CellWishes::suits(*feed, std::span(base).first(20)));
  CellWishes wishes(feed, base, static_cast<std::uint32_t>(places.size()));
  REQUIRE(wishes.update());
  // A feed that takes no bytes leaves the chunks to the reader thread, which needs no offsets.
  CHECK(wishes.take({0, 0}, chunks[0]).empty());
  for (std::uint32_t i = 0; i < places.size(); ++i) CHECK(wishes.take({kPlacesStream, i}, places[i]).empty());
  REQUIRE(wishes.update());
  CHECK(wishes.names().size() == chunks.size() - 1);
  const std::vector<net::ChunkName> before(wishes.names().begin(), wishes.names().end());
  qnv::LodView view;
  view.volume.step = 9;
  requests->note(view);
  feed->ask();
  REQUIRE(wishes.update());
  CHECK(wishes.names().size() == chunks.size() - 1);
  CHECK_FALSE(std::equal(before.begin(), before.end(), wishes.names().begin()));
  for (const net::ChunkName& name : std::vector(wishes.names())) {
    CHECK_FALSE(wishes.complete());
    CHECK(wishes.take(name, chunks[number_of_cell(name)]).empty());
    CHECK(wishes.take(name, chunks[number_of_cell(name)]).empty());
  }
  CHECK(wishes.complete());
}
