#include "app/insitu/insitu_session.h"
#include "tests/app/insitu/insitu_helpers.h"
#include "tests/app/insitu/thread_ranks.h"

#include <cmath>
#include <filesystem>

namespace gs::app::insitu {
namespace insitu_session_test {

using namespace test;

double largest_difference(const DecodedVolume& decoded, const SmoothGrid& grid, std::int64_t step = 1) {
  double most = 0;
  std::size_t i = 0;
  for (std::uint32_t z = 0; z < decoded.size[2]; ++z)
    for (std::uint32_t y = 0; y < decoded.size[1]; ++y)
      for (std::uint32_t x = 0; x < decoded.size[0]; ++x, ++i)
        most = std::max(most, std::abs(static_cast<double>(decoded.values[i]) - grid.at(x * step, y * step, z * step)));
  return most;
}

TEST_CASE("in situ: a block becomes a stream of its values within the error") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  options.error = 0.01;
  options.title = "a \"test\"";
  const Session session = opened(options);
  CHECK(gs_insitu_port(session.get()) == 0);

  const SmoothGrid grid(24);
  std::vector<double> values;
  gs_insitu_field field;
  gs_insitu_block block = grid.block(0, 24, values, field);
  block.origin[0] = 3;
  block.spacing[0] = block.spacing[1] = block.spacing[2] = 0.5;
  for (const int step : {0, 7}) {
    REQUIRE(gs_insitu_begin_step(session.get(), step, step * 0.25) == GS_INSITU_OK);
    REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
    REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  }
  for (const char* name : {"out/heat.000000.qnv", "out/heat.000007.qnv"}) {
    const DecodedVolume decoded = decoded_volume(scratch.read(name));
    CHECK(decoded.size == std::array<std::uint32_t, 3>{24, 24, 24});
    CHECK(decoded.error <= 0.01);
    CHECK(largest_difference(decoded, grid) <= 0.01);
    CHECK(decoded.layout.origin.x == 3);
    CHECK(decoded.layout.axes[1].y == 0.5f);
  }
  const std::string world = scratch.read("out/live.wrl");
  CHECK(world.find("url \"heat.000007.qnv\"") != std::string::npos);
  CHECK(world.find("title \"a \\\"test\\\", step 7, time 1.75\"") != std::string::npos);

  gs_insitu_statistics numbers{};
  numbers.size = sizeof numbers;
  REQUIRE(gs_insitu_get_statistics(session.get(), &numbers) == GS_INSITU_OK);
  CHECK(numbers.steps == 2);
  CHECK(numbers.taken == 2);
  CHECK(numbers.thinning == 1);
  CHECK(numbers.max_error == 0.01);
  CHECK(numbers.stream_bytes == std::filesystem::file_size(scratch.path("out/heat.000000.qnv")) +
                                    std::filesystem::file_size(scratch.path("out/heat.000007.qnv")));
  CHECK(numbers.sent_bytes == 0);
}

TEST_CASE("in situ: the blocks of all ranks become one stream, without their ghost layers") {
  const SmoothGrid grid(21);
  std::string alone;
  for (const int count : {1, 2, 4}) {
    INFO(count << " ranks");
    const ScratchFolder scratch;
    const std::string folder = scratch.path("out");
    ThreadRanks::run(count, [&](int rank, const gs_insitu_communicator& table) {
      gs_insitu_options options = plain_options();
      options.folder = folder.c_str();
      Session session(gs_insitu_open(&options, &table, nullptr, 0));
      std::vector<double> values;
      gs_insitu_field field;
      const gs_insitu_block block = grid.block(21 * rank / count, 21 * (rank + 1) / count, values, field, 1);
      if (gs_insitu_begin_step(session.get(), 3, 1) != GS_INSITU_OK) return;
      (void)gs_insitu_pass_block(session.get(), &block);
      (void)gs_insitu_end_step(session.get());
    });
    const std::string stream = scratch.read("out/heat.000003.qnv");
    const DecodedVolume decoded = decoded_volume(stream);
    CHECK(largest_difference(decoded, grid) <= decoded.error);
    if (count == 1) alone = stream;
    CHECK(stream == alone);
  }
}

TEST_CASE("in situ: the stream of a background thread is the same") {
  const SmoothGrid grid(16);
  std::vector<std::string> streams;
  for (const int background : {0, 1}) {
    const ScratchFolder scratch;
    const std::string folder = scratch.path("out");
    gs_insitu_options options = plain_options();
    options.folder = folder.c_str();
    options.background = background;
    const Session session = opened(options);
    std::vector<double> values;
    gs_insitu_field field;
    const gs_insitu_block block = grid.block(0, 16, values, field);
    REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
    REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
    REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
    std::ranges::fill(values, -1);  // the simulation continues
    REQUIRE(gs_insitu_flush(session.get()) == GS_INSITU_OK);
    streams.push_back(scratch.read("out/heat.000000.qnv"));
  }
  CHECK_FALSE(streams[0].empty());
  CHECK(streams[0] == streams[1]);
}

TEST_CASE("in situ: a grid above the memory limit is thinned") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  options.max_memory = 12 * 12 * 12 * 4;
  const Session session = opened(options);
  const SmoothGrid grid(25);
  std::vector<double> values;
  gs_insitu_field field;
  const gs_insitu_block block = grid.block(0, 25, values, field);
  REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
  REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
  REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  const DecodedVolume decoded = decoded_volume(scratch.read("out/heat.000000.qnv"));
  CHECK(decoded.size == std::array<std::uint32_t, 3>{7, 7, 7});
  CHECK(decoded.layout.axes[0].x == 4);
  CHECK(largest_difference(decoded, grid, 4) <= decoded.error);
  gs_insitu_statistics numbers{};
  numbers.size = sizeof numbers;
  REQUIRE(gs_insitu_get_statistics(session.get(), &numbers) == GS_INSITU_OK);
  CHECK(numbers.thinning == 4);
}

TEST_CASE("in situ: particles above the memory limit are thinned, and cells are left out with a message") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  options.max_memory = 1600;
  const Session session = opened(options);
  std::vector<float> positions(3 * 1000);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i % 97);
  gs_insitu_particles particles{};
  particles.size = sizeof particles;
  particles.positions = positions.data();
  particles.position_type = GS_INSITU_FLOAT32;
  particles.count = 1000;
  std::vector<std::int32_t> corners, offsets{0};
  std::vector<std::uint8_t> types;
  for (std::int32_t i = 0; i < 100; ++i) {
    for (const std::int32_t k : {0, 1, 2}) corners.push_back(3 * i + k);
    offsets.push_back(3 * i + 3);
    types.push_back(5);
  }
  gs_insitu_cells cells{};
  cells.size = sizeof cells;
  cells.points = positions.data();
  cells.point_type = GS_INSITU_FLOAT32;
  cells.index_type = GS_INSITU_INT32;
  cells.point_count = 1000;
  cells.connectivity = corners.data();
  cells.connectivity_count = corners.size();
  cells.offsets = offsets.data();
  cells.types = types.data();
  cells.cell_count = types.size();
  REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
  REQUIRE(gs_insitu_pass_particles(session.get(), &particles) == GS_INSITU_OK);
  REQUIRE(gs_insitu_pass_cells(session.get(), &cells) == GS_INSITU_OK);
  REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  CHECK(std::string(gs_insitu_error(session.get())).find("its triangles exceed max_memory") != std::string::npos);
  const std::vector<std::byte> bytes = bytes_of_text(scratch.read("out/particles.000000.qnv"));
  const qnv::DecodedStream decoded = qnv::decode_stream(bytes, 1 << 20);
  const auto* geometry = std::get_if<qnv::Geometry>(&decoded.content);
  REQUIRE(geometry);
  const auto* splats = geometry->as<qnv::Gaussians>();
  REQUIRE(splats);
  CHECK(splats->size() <= 100);
  CHECK(splats->size() >= 80);
  gs_insitu_statistics numbers{};
  numbers.size = sizeof numbers;
  REQUIRE(gs_insitu_get_statistics(session.get(), &numbers) == GS_INSITU_OK);
  CHECK(numbers.thinning == 11);
}

TEST_CASE("in situ: a grid is thinned if the share of run time demands it") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  options.max_share = 0.01;
  options.thin = 1;
  const Session session = opened(options);
  const SmoothGrid grid(80);  // 2 MB, more than a first step may have
  std::vector<double> values;
  gs_insitu_field field;
  const gs_insitu_block block = grid.block(0, 80, values, field);
  REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
  REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
  REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  const DecodedVolume decoded = decoded_volume(scratch.read("out/heat.000000.qnv"));
  CHECK(decoded.size == std::array<std::uint32_t, 3>{40, 40, 40});
  CHECK(largest_difference(decoded, grid, 2) <= decoded.error);
}

TEST_CASE("in situ: fields of cells, of vectors and with strides keep their places") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  options.error = 1e-4;
  const Session session = opened(options);
  constexpr std::int64_t kN = 6;  // points; there are 5 cells along each axis
  std::vector<float> reversed, vectors;
  std::vector<std::int16_t> counts;
  for (int z = 0; z < kN; ++z)
    for (int y = 0; y < kN; ++y)
      for (int x = 0; x < kN; ++x)
        for (int c = 0; c < 3; ++c) vectors.push_back(static_cast<float>(c * 100 + x + 10 * y - z));
  for (int z = 0; z + 1 < kN; ++z)
    for (int y = 0; y + 1 < kN; ++y)
      for (int x = 0; x + 1 < kN; ++x) counts.push_back(static_cast<std::int16_t>(x + 100 * y + 1000 * z));
  // The first index varies slowest, as in arrays of C with the order [x][y][z].
  for (int x = 0; x < kN; ++x)
    for (int y = 0; y < kN; ++y)
      for (int z = 0; z < kN; ++z) reversed.push_back(static_cast<float>(x + 2 * y + 4 * z));
  gs_insitu_field fields[3]{};
  fields[0].name = "counts";
  fields[0].data = counts.data();
  fields[0].type = GS_INSITU_INT16;
  fields[0].association = GS_INSITU_CELLS;
  fields[1].name = "wind speed";
  fields[1].data = vectors.data();
  fields[1].type = GS_INSITU_FLOAT32;
  fields[1].components = 3;
  fields[2].name = "reversed";
  fields[2].data = reversed.data();
  fields[2].type = GS_INSITU_FLOAT32;
  const std::int64_t strides[4] = {kN * kN * 4, kN * 4, 4, 4};
  std::copy_n(strides, 4, fields[2].strides);
  gs_insitu_block block{};
  block.size = sizeof block;
  for (const int side : {1, 3, 5}) block.whole_extent[side] = block.extent[side] = kN - 1;
  block.fields = fields;
  block.field_count = 3;
  REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
  REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
  REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);

  const DecodedVolume cells = decoded_volume(scratch.read("out/counts.000000.qnv"));
  CHECK(cells.size == std::array<std::uint32_t, 3>{5, 5, 5});
  CHECK(cells.layout.origin.x == 0.5);
  CHECK(cells.stored == qnv::VoxelType::i16);
  CHECK(cells.values[(3 * 5 + 2) * 5 + 4] == 3204);
  const DecodedVolume other = decoded_volume(scratch.read("out/reversed.000000.qnv"));
  CHECK(other.values[(std::size_t{1} * kN + 2) * kN + 5] == Approx(5 + 2 * 2 + 4 * 1).margin(1e-3));
  const std::vector<std::byte> bytes = bytes_of_text(scratch.read("out/wind_speed.000000.qnv"));
  const qnv::DecodedStream decoded = qnv::decode_stream(bytes, 1 << 20);
  REQUIRE(decoded.header);
  CHECK(decoded.header->more_grids.size() == 2);
}

TEST_CASE("in situ: wrong calls give messages and keep the session usable") {
  char error[256] = "";
  gs_insitu_options options = plain_options();
  CHECK_FALSE(gs_insitu_open(&options, nullptr, error, sizeof error));
  CHECK(std::string(error) == "there is no output; expected a folder, or serve = 1");
  options.folder = "/proc/no/such/folder";
  CHECK_FALSE(gs_insitu_open(&options, nullptr, error, sizeof error));
  CHECK(std::string(error).starts_with("/proc/no/such/folder: the folder cannot be created"));
  CHECK_FALSE(gs_insitu_open(nullptr, nullptr, error, sizeof error));
  options.size = sizeof options + 64;
  CHECK_FALSE(gs_insitu_open(&options, nullptr, error, sizeof error));
  gs_insitu_communicator broken{};
  options = plain_options();
  CHECK_FALSE(gs_insitu_open(&options, &broken, error, sizeof error));

  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  options.folder = folder.c_str();
  const Session session = opened(options);
  const SmoothGrid grid(8);
  std::vector<double> values;
  gs_insitu_field field;
  gs_insitu_block block = grid.block(0, 8, values, field);
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_INVALID);
  CHECK(gs_insitu_end_step(session.get()) == GS_INSITU_INVALID);
  REQUIRE(gs_insitu_begin_step(session.get(), 0, 0) == GS_INSITU_OK);
  CHECK(gs_insitu_begin_step(session.get(), 1, 0) == GS_INSITU_INVALID);
  CHECK(gs_insitu_pass_block(session.get(), nullptr) == GS_INSITU_INVALID);
  block.size = 8;
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_INVALID);
  block.size = sizeof block;
  block.extent[1] = -5;
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_INVALID);
  CHECK(std::string(gs_insitu_error(session.get())) ==
        "the extent of a block is empty or too large; expected first <= last along each axis");
  block.extent[1] = 7;
  field.type = 99;
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_INVALID);
  CHECK(std::string(gs_insitu_error(session.get())) == "field 'heat': unknown type 99; expected a gs_insitu_type");
  field.type = GS_INSITU_FLOAT64;
  field.components = 10;
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_INVALID);
  field.components = 0;
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
  block.spacing[1] = 2;
  CHECK(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_INVALID);
  CHECK(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  CHECK(std::filesystem::exists(scratch.path("out/heat.000000.qnv")));
  CHECK(gs_insitu_begin_step(session.get(), -1, 0) == GS_INSITU_INVALID);
  CHECK(gs_insitu_version() == GS_INSITU_VERSION);
}

TEST_CASE("in situ: ranks with different grids lose the step, with a message on each") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  std::array<int, 2> results{};
  std::array<std::string, 2> messages;
  ThreadRanks::run(2, [&](int rank, const gs_insitu_communicator& table) {
    gs_insitu_options options = plain_options();
    options.folder = folder.c_str();
    Session session(gs_insitu_open(&options, &table, nullptr, 0));
    const SmoothGrid grid(8 + rank);
    std::vector<double> values;
    gs_insitu_field field;
    const gs_insitu_block block = grid.block(0, 8, values, field);
    (void)gs_insitu_begin_step(session.get(), 0, 0);
    (void)gs_insitu_pass_block(session.get(), &block);
    const auto place = static_cast<std::size_t>(rank);
    results[place] = gs_insitu_end_step(session.get());
    messages[place] = gs_insitu_error(session.get());
  });
  for (const std::size_t rank : {0U, 1U}) {
    CHECK(results[rank] == GS_INSITU_FAILED);
    CHECK(messages[rank].starts_with("the blocks of two ranks name different grids"));
  }
  CHECK_FALSE(std::filesystem::exists(scratch.path("out/heat.000000.qnv")));
}

TEST_CASE("in situ: only each n-th step is taken") {
  const ScratchFolder scratch;
  const std::string folder = scratch.path("out");
  gs_insitu_options options = plain_options();
  options.folder = folder.c_str();
  options.every = 5;
  const Session session = opened(options);
  const SmoothGrid grid(8);
  std::vector<double> values;
  gs_insitu_field field;
  const gs_insitu_block block = grid.block(0, 8, values, field);
  std::vector<int> taken;
  for (int step = 0; step < 20; ++step) {
    if (gs_insitu_begin_step(session.get(), step, 0) != GS_INSITU_OK) continue;
    taken.push_back(step);
    REQUIRE(gs_insitu_pass_block(session.get(), &block) == GS_INSITU_OK);
    REQUIRE(gs_insitu_end_step(session.get()) == GS_INSITU_OK);
  }
  CHECK(taken == std::vector<int>{0, 5, 10, 15});
}

}  // namespace insitu_session_test
}  // namespace gs::app::insitu
